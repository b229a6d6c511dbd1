// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/layouts/detail/cpp_tokens.h"

// What the classes and functions of C++ sources declare, as far as it tells what their archives hold. Names are without
// namespaces, but for those in a namespace of the system's own.
namespace slamdb::layouts {

struct CppPlace {
  std::string file;
  std::uint32_t line = 0;

  std::string ToString() const { return file + ":" + std::to_string(line); }
};

struct CppMember {
  CppTokens type;
  std::vector<std::string> sizes;  // of an array: `[3]`
};

struct CppClass {
  CppPlace place;
  std::map<std::string, CppMember, std::less<>> members;
  std::map<std::string, CppTokens, std::less<>> aliases;  // typedef, using; of an enumeration `int`
  bool abstract = false;                                  // declares a pure virtual function
};

// A function that may say what an archive holds.
struct CppFunction {
  CppPlace place;
  std::string owner;  // class of a member function; empty: a free one
  std::string name;
  CppTokens parameters, body;
  bool skips_lines = false;  // an #else in it was not looked at
};

struct CppIndex {
  std::deque<std::string> texts;  // what the tokens refer to
  std::map<std::string, CppClass, std::less<>> classes;
  std::map<std::string, CppTokens, std::less<>> aliases;
  std::vector<CppFunction> functions;
  std::map<std::string, std::string, std::less<>> export_keys;  // by class: BOOST_CLASS_EXPORT_GUID and relatives
  std::map<std::string, CppPlace, std::less<>> versions;        // classes with BOOST_CLASS_VERSION

  // Adds what a file declares.
  void Add(const std::string& file, std::string text);
  // The functions of that class and name; a class without name: free ones.
  std::vector<const CppFunction*> Find(std::string_view owner, std::string_view name) const;
};

// Adds the variables of a declaration without its semicolon; nothing where it is none.
void MembersOfDeclaration(std::span<const CppToken> declaration,
                          std::map<std::string, CppMember, std::less<>>& members);

}  // namespace slamdb::layouts
