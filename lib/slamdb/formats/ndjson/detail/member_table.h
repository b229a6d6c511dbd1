// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bitset>
#include <functional>
#include <string_view>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/ndjson/detail/read_members.h"

namespace slamdb::detail {

// Which members of an object were there.
using Given = std::bitset<192>;

// How the object of an entity is read: a tree of names, of which those of fields.h that stand alike, `features.grid`,
// are objects in objects. Constant once it is made.
template <class Entity>
class MemberTable {
 public:
  using Read = std::function<void(JsonScanner&, Entity&)>;

  MemberTable() {
    ForEachField(static_cast<const Entity*>(nullptr), [&](std::string_view name, auto... path) {
      if (name == "distortion.data") name = kMatrixValues;
      fields_.push_back(
          Add(name, [path...](JsonScanner& json, Entity& entity) { ReadMember(json, Member(entity, path...)); }));
    });
  }

  // One more member, or another way to read that one; without `read` the caller reads it.
  std::size_t Add(std::string_view name, Read read = {}) {
    std::size_t object = 0;
    for (std::size_t dot = name.find('.'); dot != name.npos; dot = name.find('.')) {
      object = ChildOf(object, name.substr(0, dot));
      nodes_[object].is_object = true;
      name.remove_prefix(dot + 1);
    }
    const std::size_t node = ChildOf(object, name);
    nodes_[node].read = std::move(read);
    return node;
  }
  // Members that must be there.
  void Require(std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names) required_.push_back(Find(name));
  }
  // The node of a field, `features.count`; 0 when there is none.
  std::size_t Find(std::string_view name) const {
    std::size_t node = 0;
    for (bool more = true; more;) {
      const std::size_t dot = name.find('.');
      more = dot != name.npos;
      node = FindChild(node, name.substr(0, dot));
      if (node == 0) return 0;
      if (more) name.remove_prefix(dot + 1);
    }
    return node;
  }

  // Reads the object; extra(name) reads a member that the caller reads.
  template <class Extra>
  Given ReadObject(JsonScanner& json, Entity& entity, const Extra& extra) const {
    Given given;
    ReadNode(json, 0, entity, extra, given);
    for (const std::size_t node : required_)
      if (!given[node]) json.Refuse(Concat("the member `", nodes_[node].name, "` is missing"));
    return given;
  }

  // Whether every field was there, but for those that have a node in `optional`.
  bool HasAllFields(const Given& given, const Given& optional) const {
    return std::ranges::all_of(fields_, [&](std::size_t node) { return given[node] || optional[node]; });
  }
  // Gives `entity` the fields of `original` that were there.
  void Restore(const Given& given, const Entity& original, Entity& entity) const {
    auto node = fields_.begin();
    ForEachField(&entity, [&](std::string_view, auto... path) {
      if (given[*node++]) Member(entity, path...) = Member(original, path...);
    });
  }

 private:
  struct Node {
    std::string_view name;
    bool is_object = false;
    Read read;
    std::vector<std::size_t> children;
  };

  std::size_t FindChild(std::size_t parent, std::string_view name) const {
    std::size_t from = 0;
    return FindChild(parent, name, from);
  }
  // The same from a place on, which goes behind what is found: members mostly stand in the order of the fields.
  std::size_t FindChild(std::size_t parent, std::string_view name, std::size_t& from) const {
    const std::vector<std::size_t>& children = nodes_[parent].children;
    for (std::size_t tried = 0; tried < children.size(); ++tried, ++from) {
      if (from >= children.size()) from = 0;
      if (nodes_[children[from]].name == name) return children[from++];
    }
    return 0;
  }
  std::size_t ChildOf(std::size_t parent, std::string_view name) {
    if (const std::size_t child = FindChild(parent, name)) return child;
    nodes_.emplace_back().name = name;
    nodes_[parent].children.push_back(nodes_.size() - 1);
    return nodes_.size() - 1;
  }
  template <class Extra>
  void ReadNode(JsonScanner& json, std::size_t object, Entity& entity, const Extra& extra, Given& given) const {
    std::size_t next = 0;
    json.Object([&](std::string_view name) {
      const std::size_t node = FindChild(object, name, next);
      if (node == 0) json.Refuse("there is no such member");
      if (given[node]) json.Refuse("stands there twice");
      given.set(node);
      if (nodes_[node].is_object)
        ReadNode(json, node, entity, extra, given);
      else if (nodes_[node].read)
        nodes_[node].read(json, entity);
      else
        extra(name);
    });
  }

  std::vector<Node> nodes_ = std::vector<Node>(1);
  std::vector<std::size_t> fields_, required_;
};

}  // namespace slamdb::detail
