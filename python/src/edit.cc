// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "python/src/arguments.h"
#include "python/src/held_atlas.h"
#include "python/src/module.h"
#include "python/src/reopen.h"
#include "python/src/row_class.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/repair/journal.h"
#include "slamdb/model/digest.h"

// Sessions of editing, which are put in place whole, and taken back.
namespace slamdb::python {

namespace py = pybind11;

namespace {

using Held = std::shared_ptr<HeldAtlas>;
using KeptJournal = std::shared_ptr<const Journal>;

Journal JournalAt(const py::object& path) {
  const std::string from = TextOfPath(path);
  return WithoutGil([&] { return ReadJournal(from); });
}

// A session works on a copy. What happens to the atlas meanwhile would be lost when the copy is put in its place, and
// is an error then.
// Threads may share one: what a call works on is its own, and of two that end the edit one comes first.
class Edit {
 public:
  Edit(Held atlas, std::string label, bool keeps_journal)
      : atlas_(std::move(atlas)), label_(std::move(label)), keeps_journal_(keeps_journal), base_(atlas_->value()) {
    atlas_->RequireOpen();
    const Unlocked unlocked;
    original_ = HashWithoutEncoding(*base_);
    work_ = std::make_shared<HeldAtlas>(*base_);
  }
  ~Edit() { Drop(); }
  Edit(const Edit&) = delete;
  Edit& operator=(const Edit&) = delete;

  const Held& work() const {
    RequireOpen();
    return work_;
  }
  bool is_open() const { return work_ != nullptr; }
  bool has_journal() const { return journal_ != nullptr; }

  void Commit() {
    RequireOpen();
    const Held work = work_;
    const std::shared_ptr<Atlas> base = base_;
    journal_ = atlas_->TakeOver(base, *work, [&](const Atlas& made) { return JournalOf(*base, made); });
    Drop();
  }

  // Maps and the atlas of the edit, which somebody may keep, show what they show, and are changed no more.
  void Drop() {
    if (work_) work_->Close();
    work_.reset();
    base_.reset();
  }

  KeptJournal journal() const {
    if (work_) throw Error(ErrorKind::kUsage, "the edit is still open: its journal is there when it is put in place");
    if (!journal_) throw Error(ErrorKind::kUsage, "the edit was dropped, or kept no journal");
    return journal_;
  }
  const Held& atlas() const { return atlas_; }

 private:
  void RequireOpen() const {
    if (!work_) throw Error(ErrorKind::kUsage, "the edit is over: begin another one with atlas.edit()");
  }

  KeptJournal JournalOf(const Atlas& base, const Atlas& changed) const {
    if (HashWithoutEncoding(base) != original_) HeldAtlas::FailChanged();
    if (!keeps_journal_) return nullptr;
    auto journal = std::make_shared<Journal>(Journal{.original = original_, .encoding = base.encoding});
    AppendChanges(base, changed, label_, *journal);
    journal->repaired = HashWithoutEncoding(changed);
    return journal;
  }

  Held atlas_;
  std::string label_;
  bool keeps_journal_;
  std::shared_ptr<Atlas> base_;
  std::uint64_t original_ = 0;
  Held work_;  // null: over
  KeptJournal journal_;
};

std::uint64_t Undo(HeldAtlas& atlas, const Journal& journal) {
  const bool is_last = !atlas.history().empty() && atlas.history().back()->original == journal.original &&
                       atlas.history().back()->repaired == journal.repaired;
  const std::uint64_t edits = atlas.Apply([&](Atlas& changed) { return UndoRepair(changed, journal).edits; });
  if (is_last) atlas.ForgetLast();
  return edits;
}

// Of a journal, its file, or the last edit of this atlas.
std::uint64_t UndoBy(HeldAtlas& atlas, const py::object& journal) {
  if (py::isinstance<Journal>(journal)) return Undo(atlas, journal.cast<const Journal&>());
  if (!journal.is_none()) return Undo(atlas, JournalAt(journal));
  if (atlas.history().empty())
    throw Error(ErrorKind::kNotPossible, "there is no edit to take back: give the journal of one, or its file");
  const KeptJournal last = atlas.history().back();
  return Undo(atlas, *last);
}

void DefineJournal(py::module_& module) {
  py::class_<Journal, std::shared_ptr<Journal>>(module, "Journal",
                                                "What an edit or a repair changed; enough to take it back.")
      .def_property_readonly(
          "text", [](const Journal& j) { return ToJson(j); }, "JSON, as docs/repair.md describes the file")
      .def("__len__", [](const Journal& j) { return j.edits.size(); })
      .def(
          "save",
          [](const Journal& j, const py::object& path, bool overwrite) {
            const std::string to = TextOfPath(path);
            const Unlocked unlocked;
            WriteJournal(j, to, {.overwrite = overwrite});
          },
          py::arg("path"), py::kw_only(), py::arg("overwrite") = false,
          "Write it to a file, with which `slamdb repair --undo` takes the change back, too.")
      .def_static(
          "read", [](const py::object& path) { return std::make_shared<Journal>(JournalAt(path)); }, py::arg("path"),
          "Read the file of one.")
      .def("__repr__", [](const Journal& j) { return "<slamdb.Journal: " + Counted(j.edits.size(), "edit") + ">"; });
}

std::string TextOf(const Edit& edit) {
  if (edit.is_open()) return "<slamdb.Edit: open>";
  if (!edit.has_journal()) return "<slamdb.Edit: over>";
  return "<slamdb.Edit: put in place, " + Counted(edit.journal()->edits.size(), "edit") + ">";
}

void DefineSession(py::module_& module) {
  py::class_<Edit>(module, "Edit", R"(A change of an atlas that is put in place whole, or not at all.

    with atlas.edit() as edit:
        edit.maps[0].remove_points(edit.maps[0].points.weights < 3)
    edit.undo()

Columns of edit.maps are writable. What the block raises drops the change. The atlas must stay as it is meanwhile:
putting the change in place raises NotPossibleError where it was changed, or another thread is changing it.
Afterwards edit.maps and edit.atlas are over: maps that were kept can be read, and raise UsageError for changes.)")
      .def_property_readonly("atlas", &Edit::work, "the atlas as it will be")
      .def_property_readonly(
          "maps", [](const Edit& e) { return py::object(py::cast(e.work()).attr("maps")); }, "its maps")
      .def("commit", &Edit::Commit, "Put the change in place, as leaving the `with` does.")
      .def("drop", &Edit::Drop, "Forget the change.")
      .def_property_readonly(
          "journal", [](const Edit& e) { return std::const_pointer_cast<Journal>(e.journal()); },
          "what was changed, as a Journal; there once the change is in place")
      .def(
          "undo", [](const Edit& e) { return Undo(*e.atlas(), *e.journal()); },
          "Make the atlas bit by bit what it was before; returns how many edits were taken back. Raises\n"
          "NotPossibleError when it was changed since: take later edits back first.")
      .def("__repr__", &TextOf)
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__", [](Edit& e, const py::object& raised, const py::object&, const py::object&) {
        if (e.is_open()) raised.is_none() ? e.Commit() : e.Drop();
      });
}

void DefineAtlasEditing(py::class_<HeldAtlas, std::shared_ptr<HeldAtlas>> atlas) {
  atlas
      .def(
          "edit",
          [](const Held& a, std::string label, bool journal) {
            return std::make_unique<Edit>(a, std::move(label), journal);
          },
          py::kw_only(), py::arg("label") = "edit", py::arg("journal") = true,
          R"(Begin a change that is put in place whole; see Edit.

label: what the journal calls it
journal: False saves the comparison that it takes; the change cannot be taken back then)")
      .def("undo", &UndoBy, py::arg("journal") = py::none(),
           R"(Take a change back, bit by bit; returns how many edits that were.

journal: a Journal or its file, of an edit or of `slamdb repair`; by default of the last edit of this atlas
Raises NotPossibleError when the atlas is not what the change made.)")
      .def_property_readonly(
          "history",
          [](const HeldAtlas& a) {
            py::list journals;
            for (const KeptJournal& journal : a.history()) journals.append(std::const_pointer_cast<Journal>(journal));
            return journals;
          },
          "journals of the edits that were put in place and not taken back, the last one last");
}

}  // namespace

void DefineEditing(py::module_& module) {
  DefineJournal(module);
  DefineSession(module);
  DefineAtlasEditing(Reopen<py::class_<HeldAtlas, std::shared_ptr<HeldAtlas>>>(module, "Atlas"));
}

}  // namespace slamdb::python
