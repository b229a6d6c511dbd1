// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/module.h"
#include "python/src/verb.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/formats/layouts/from_source.h"
#include "slamdb/formats/layouts/layout.h"
#include "slamdb/formats/layouts/layout_text.h"
#include "slamdb/formats/layouts/report.h"
#include "slamdb/formats/orbslam3/infer_layout.h"

// Layouts of forks of ORB-SLAM3. slamdb/layouts.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

namespace {}  // namespace

void DefineLayouts(py::module_& module) {
  DefineReport(module, "layouts_list", [](Arguments&) { return [](Notices&) { return ToJson(KnownLayouts()); }; });
  DefineReport(module, "layouts_show", [](Arguments& given) {
    return [layout = given.Path("layout")](Notices&) { return ToJson(LoadLayout(layout)); };
  });
  DefineReport(module, "layouts_infer", [](Arguments& given) {
    InferOptions options;
    given.Take("choose", options.choice, cli::kLayoutChoice);
    return [options, path = given.Path("path"), file = given.Output("output")](Notices& notices) {
      const InferredLayout inferred = InferLayout(path, options);
      if (!inferred.alternatives.empty()) notices.Warn("other layouts fit as well");
      if (!inferred.doubts.empty()) notices.Warn("the layout is in doubt");
      file.Write(LayoutText(inferred.layout));
      return ToJson(inferred, {.input = path, .output = file.path});
    };
  });
  DefineReport(module, "layouts_from_source", [](Arguments& given) {
    return [folder = given.Path("folder"), file = given.Output("output")](Notices&) {
      const DerivedLayout derived = DeriveLayoutOfFolder(folder);
      file.Write(LayoutText(derived.layout));
      return ToJson(derived, {.input = folder, .output = file.path});
    };
  });
}

}  // namespace slamdb::python
