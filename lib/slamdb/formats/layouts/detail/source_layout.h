// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/formats/layouts/detail/cpp_index.h"
#include "slamdb/formats/layouts/detail/cpp_types.h"

// What serialize functions say of an archive.
namespace slamdb::layouts {

struct SourceMember {
  std::string name, type;  // a word of a layout; `?` when it was not understood
};

struct SourceClass {
  std::string name;
  std::vector<SourceMember> members;
  std::vector<std::string> registers;  // classes with register_type, in order
  std::string export_key;              // empty: none
  bool abstract = false;
};

// What was not understood, and where.
struct SourceQuestion {
  CppPlace place;
  std::string text;
};

struct SourceLayout {
  std::vector<SourceMember> root;
  std::vector<SourceClass> classes;  // that the root comes to, in the order met
  std::vector<SourceQuestion> questions;
};

// The name of the archive: the last word in front of the first comma of `Archive& ar, const unsigned int version`.
std::string FirstParameter(std::span<const CppToken> parameters);

// Reads the body of a function that archives.
class SerializeBody {
 public:
  SerializeBody(const CppIndex& index, const CppFunction& function, std::vector<SourceQuestion>& questions);

  // What it archives, in order; of both branches of every condition where `all_branches`.
  // `archive`: the name of the variable; a function of a class has it as its first parameter.
  void Read(std::string_view archive, bool all_branches);

  std::vector<SourceMember> members;
  std::vector<std::string> registers;

 private:
  static constexpr int kDeepestHelper = 4;

  using Tokens = std::span<const CppToken>;
  struct Variable {
    CppMember member;
    std::string in_class;
    std::string name;
    bool known = false;
  };

  void Step();
  void If();
  std::size_t EndOfStatement(std::size_t from) const;
  bool Archives(Tokens tokens) const;
  void Simple(Tokens statement);
  void Operands(Tokens list);
  void Operand(Tokens expression);
  void Method(Tokens call);
  bool Helper(Tokens call);
  bool HelperOf(std::string_view helper, Tokens argument);
  bool OwnHelper(std::string_view helper, const Variable& variable);
  void Call(std::string_view name, Tokens type, Tokens arguments, Tokens expression);
  void MakeArray(Tokens arguments, Tokens expression);
  void Add(const Variable& variable, Tokens expression);
  void AddArray(const std::string& name, const CppTypes::Array& array);
  Variable Find(Tokens expression) const;
  void Ask(Tokens where, std::string text);
  void AskMember(Tokens where, std::string name, std::string text);

  const CppIndex& index_;
  const CppFunction& function_;
  std::vector<SourceQuestion>& questions_;
  const CppTypes types_;
  const Tokens body_;
  std::string archive_;
  bool all_branches_ = false;
  std::size_t at_ = 0;
  int depth_ = 0;             // of helpers in helpers
  bool was_loading_ = false;  // the last condition, whose `else` is for saving
  std::map<std::string, CppMember, std::less<>> locals_;
};

// The layout that the sources write: from the function that makes the archive, or else from the class Atlas, on.
SourceLayout LayoutOfSources(const CppIndex& index);

}  // namespace slamdb::layouts
