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

namespace {

// Where a layout that was found goes, for layout= of other verbs.
struct LayoutFile {
  std::string path;
  bool overwrite = false;

  void Write(const Layout& layout) const {
    if (path.empty()) return;
    AtomicFile file(path, {.overwrite = overwrite});
    file.Write(LayoutText(layout));
    file.Commit();
  }
};

LayoutFile FileOf(Arguments& given) {
  return {.path = given.Path("output"), .overwrite = given.Get<bool>("overwrite")};
}

}  // namespace

void DefineLayouts(py::module_& module) {
  DefineReport(module, "layouts_list", [](Arguments&) { return [](Notices&) { return ToJson(KnownLayouts()); }; });
  DefineReport(module, "layouts_show", [](Arguments& given) {
    return [layout = given.Path("layout")](Notices&) { return ToJson(LoadLayout(layout)); };
  });
  DefineReport(module, "layouts_infer", [](Arguments& given) {
    InferOptions options;
    given.Take("choose", options.choice);
    return [options, path = given.Path("path"), file = FileOf(given)](Notices& notices) {
      const InferredLayout inferred = InferLayout(path, options);
      if (!inferred.alternatives.empty()) notices.Warn("other layouts fit as well");
      if (!inferred.doubts.empty()) notices.Warn("the layout is in doubt");
      file.Write(inferred.layout);
      return ToJson(inferred, {.input = path, .output = file.path});
    };
  });
  DefineReport(module, "layouts_from_source", [](Arguments& given) {
    return [folder = given.Path("folder"), file = FileOf(given)](Notices&) {
      const DerivedLayout derived = DeriveLayoutOfFolder(folder);
      file.Write(derived.layout);
      return ToJson(derived, {.input = folder, .output = file.path});
    };
  });
}

}  // namespace slamdb::python
