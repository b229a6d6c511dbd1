// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/detail/member_forms.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/layouts/detail/wire_walk.h"
#include "slamdb/model/detail/matrix_types.h"

namespace slamdb::layouts {
namespace {

using Kind = LayoutType::Kind;
using Number = LayoutType::Number;

constexpr std::size_t kPose = 7;

bool IsFloats(const LayoutType& type) {
  return type.kind == Kind::kArray &&
         (type.elements[0].number == Number::kF32 || type.elements[0].number == Number::kF64) &&
         type.elements[0].kind == Kind::kNumber;
}
bool IsPose(const LayoutType& type) { return IsFloats(type) && type.count == kPose; }

bool IsReal(Number number) { return number == Number::kF32 || number == Number::kF64; }

// The same lists of numbers, of whichever width.
bool SameShape(const LayoutType& type, const LayoutType& own) {
  if (type.kind != own.kind || type.count != own.count || type.elements.size() != own.elements.size()) return false;
  if (type.kind == Kind::kNumber) return IsReal(type.number) || !IsReal(own.number);
  const bool is_list = type.kind == Kind::kArray || type.kind == Kind::kVector || type.kind == Kind::kSet ||
                       type.kind == Kind::kList || type.kind == Kind::kMap;
  return is_list &&
         std::equal(type.elements.begin(), type.elements.end(), own.elements.begin(), own.elements.end(), SameShape);
}

std::size_t Width(Number number) {
  std::size_t width = 0;
  WithNumberType(number, [&](auto zero) { width = sizeof(zero); });
  return width;
}

bool Has(std::string_view form, std::string_view word) {
  while (!form.empty()) {
    const std::size_t end = std::min(form.find('.'), form.size());
    if (form.substr(0, end) == word) return true;
    form.remove_prefix(std::min(end + 1, form.size()));
  }
  return false;
}

// ---- Poses

Numbers Transposed(const Numbers& matrix, std::size_t rows) {
  Numbers other;
  const std::size_t columns = matrix.size() / rows;
  for (std::size_t column = 0; column < columns; ++column)
    for (std::size_t row = 0; row < rows; ++row) other.push_back(matrix[row * columns + column]);
  return other;
}

// w x y z and the translation, from the rows of a matrix.
Numbers PoseOfRows(const Numbers& rows) {
  if (rows.size() != 12 && rows.size() != 16) return {};
  Eigen::Matrix3d rotation;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      rotation(row, column) = static_cast<double>(rows[static_cast<std::size_t>(4 * row + column)]);
  if (!rotation.allFinite()) return {};
  const double scale = std::cbrt(std::abs(rotation.determinant()));
  const Eigen::Quaterniond q(rotation);  // of length 1 when that is a rotation
  const bool is_rotation = std::abs(scale - 1) < 1e-2;
  const Eigen::Quaterniond unit = is_rotation ? q.normalized() : q;
  return {unit.w(), unit.x(), unit.y(), unit.z(), rows[3], rows[7], rows[11]};
}
Numbers RowsOfPose(const Numbers& pose) {
  const auto at = [&](std::size_t i) { return static_cast<double>(pose[i]); };
  const Eigen::Matrix3d rotation = Eigen::Quaterniond(at(0), at(1), at(2), at(3)).normalized().toRotationMatrix();
  Numbers values;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) values.push_back(rotation(row, column));
    values.push_back(pose[static_cast<std::size_t>(4 + row)]);
  }
  values.insert(values.end(), {0, 0, 0, 1});
  return values;
}
Numbers Inverse(const Numbers& pose) {
  const auto at = [&](std::size_t i) { return static_cast<double>(pose[i]); };
  const Eigen::Quaterniond q(at(0), -at(1), -at(2), -at(3));
  const Eigen::Vector3d t = -(q * Eigen::Vector3d(at(4), at(5), at(6)));
  return {pose[0], -pose[1], -pose[2], -pose[3], t.x(), t.y(), t.z()};
}

// ---- Bytes

class Flattening {
 public:
  Flattening(std::string_view bytes, std::uint64_t at) : bytes_(bytes), at_(at) {}

  void Take(const LayoutType& type) {
    switch (type.kind) {
      case Kind::kNumber:
        return TakeNumber(type.number);
      case Kind::kArray:
        for (std::uint32_t i = 0; i < type.count; ++i) Take(type.elements[0]);
        return;
      case Kind::kMatrix:
        return TakeMatrix();
      default:
        break;
    }
    const auto count = NumberAt<std::uint64_t>(bytes_, at_).value_or(0);
    const bool versioned = type.kind != Kind::kVector || type.elements[0].kind != Kind::kNumber;
    at_ += sizeof(count) + (versioned ? sizeof(std::uint32_t) : 0);
    if (at_ > bytes_.size() || count > bytes_.size() - at_) return;
    numbers.push_back(static_cast<long double>(count));
    for (std::uint64_t i = 0; i < count; ++i)
      for (const LayoutType& element : type.elements) Take(element);
  }

  Numbers numbers;

 private:
  void TakeNumber(Number number) {
    WithNumberType(number, [&](auto zero) {
      numbers.push_back(static_cast<long double>(NumberAt<decltype(zero)>(bytes_, at_).value_or(zero)));
      at_ += sizeof(zero);
    });
  }
  // Of at most 4 x 4 floats or doubles.
  void TakeMatrix() {
    const auto columns = NumberAt<std::int32_t>(bytes_, at_).value_or(0),
               rows = NumberAt<std::int32_t>(bytes_, at_ + 4).value_or(0),
               type = NumberAt<std::int32_t>(bytes_, at_ + 8).value_or(0);
    at_ += 13;
    if ((type != detail::kCv32F && type != detail::kCv64F) || columns < 1 || columns > 4 || rows < 1 || rows > 4)
      return;
    for (int i = 0; i < columns * rows; ++i) TakeNumber(type == detail::kCv32F ? Number::kF32 : Number::kF64);
  }

  const std::string_view bytes_;
  std::uint64_t at_;
};

class Writing {
 public:
  explicit Writing(const Numbers& numbers) : numbers_(numbers) {}

  void Put(const LayoutType& type) {
    if (type.kind == Kind::kNumber) return PutNumber(type.number, Next());
    std::uint64_t count = type.count;
    if (type.kind != Kind::kArray) {
      const long double counted = Next();
      count =
          counted > 0 && counted <= static_cast<long double>(numbers_.size()) ? static_cast<std::uint64_t>(counted) : 0;
      PutNumber(Number::kU64, static_cast<long double>(count));
      if (type.kind != Kind::kVector || type.elements[0].kind != Kind::kNumber) PutNumber(Number::kU32, 0);
    }
    for (std::uint64_t i = 0; i < count; ++i)
      for (const LayoutType& element : type.elements) Put(element);
  }

  std::string bytes;

 private:
  long double Next() { return next_ < numbers_.size() ? numbers_[next_++] : 0; }
  void PutNumber(Number number, long double value) {
    WithNumberType(number, [&](auto zero) {
      const auto narrow = Narrowed<decltype(zero)>(value);
      char raw[sizeof(narrow)];
      std::memcpy(raw, &narrow, sizeof(narrow));
      bytes.append(raw, sizeof(narrow));
    });
  }

  const Numbers& numbers_;
  std::size_t next_ = 0;
};

// ---- What forks may have

void AddForms(std::string_view name, const char* form, std::initializer_list<const char*> types,
              std::vector<LayoutMember>& forms) {
  for (const char* type : types) forms.push_back({detail::Concat(name, *form == '\0' ? "" : ".", form), type});
}

// A time as a whole number.
struct TimeForm {
  const char* form;
  long double per_second;
};
constexpr std::array kTimes = {TimeForm{"nanoseconds", 1e9L}, TimeForm{"microseconds", 1e6L},
                               TimeForm{"milliseconds", 1e3L}};

const TimeForm* FindTime(std::string_view form) {
  const auto found =
      std::find_if(kTimes.begin(), kTimes.end(), [&](const TimeForm& time) { return form == time.form; });
  return found == kTimes.end() ? nullptr : &*found;
}

// The type with numbers of the other width.
LayoutType OtherWidth(LayoutType type) {
  constexpr std::array<std::pair<Number, Number>, 8> kOther{{{Number::kF32, Number::kF64},
                                                             {Number::kF64, Number::kF32},
                                                             {Number::kI32, Number::kI64},
                                                             {Number::kU32, Number::kU64},
                                                             {Number::kU64, Number::kU32},
                                                             {Number::kI64, Number::kI32},
                                                             {Number::kLong, Number::kI32},
                                                             {Number::kBool, Number::kI32}}};
  if (type.kind == Kind::kNumber)
    for (const auto& [from, to] : kOther)
      if (type.number == from) return {.kind = Kind::kNumber, .number = to};
  for (LayoutType& element : type.elements) element = OtherWidth(std::move(element));
  return type;
}

// Two members side by side that are one of ORB-SLAM3's.
const std::array<LayoutMember, 6> kHalves{{{"mTimeStamp.seconds", "u32"},
                                           {"mTimeStamp.nanoseconds", "u32"},
                                           {"mBowVec.words", "vec<u32>"},
                                           {"mBowVec.weights", "vec<f64>"},
                                           {"mFeatVec.nodes", "vec<u32>"},
                                           {"mFeatVec.features", "vec<vec<u32>>"}}};

}  // namespace

const LayoutType* OwnTypeOf(std::string_view of_class, std::string_view name) {
  static const std::map<std::pair<std::string, std::string>, LayoutType> kTypes = [] {
    std::map<std::pair<std::string, std::string>, LayoutType> types;
    for (const LayoutClass& of : KnownLayouts().front().classes)
      for (const LayoutMember& member : of.members) types[{of.name, member.name}] = ParseLayoutType(member.type);
    return types;
  }();
  const auto found = kTypes.find({std::string(of_class), std::string(name)});
  return found == kTypes.end() ? nullptr : &found->second;
}

std::vector<LayoutMember> OtherForms(std::string_view name, const LayoutType& own) {
  std::vector<LayoutMember> forms;
  if (!SameShape(own, own)) return forms;  // no numbers
  if (own.kind == Kind::kMap) {
    AddForms(name, "", {"map<u64,u64>", "map<u32,i32>", "map<u32,u64>"}, forms);
  } else {
    forms.push_back({std::string(name), ToString(OtherWidth(own))});
  }
  if (name == "mTimeStamp")
    for (const TimeForm& time : kTimes) AddForms(name, time.form, {"u64"}, forms);
  if (IsFloats(own) && (own.count == 3 || own.count == 9)) AddForms(name, "", {"mat"}, forms);
  if (!IsPose(own)) return forms;
  AddForms(name, "", {"mat"}, forms);
  AddForms(name, "xyzw", {"arr<f32,7>", "arr<f64,7>"}, forms);
  for (const char* form : {"columns", "rows"})
    AddForms(name, form, {"arr<f32,16>", "arr<f64,16>", "arr<f32,12>", "arr<f64,12>"}, forms);
  for (const char* form : {"inverse", "inverse.xyzw"}) AddForms(name, form, {"arr<f32,7>", "arr<f64,7>"}, forms);
  for (const char* form : {"inverse.columns", "inverse.rows"})
    AddForms(name, form, {"arr<f32,16>", "arr<f64,16>"}, forms);
  AddForms(name, "inverse", {"mat"}, forms);
  return forms;
}

std::vector<LayoutMember> AllForms(std::string_view name, const LayoutType& own) {
  std::vector<LayoutMember> forms = OtherForms(name, own);
  forms.push_back({std::string(name), ToString(own)});
  return forms;
}

bool IsForm(std::string_view form, const LayoutType& type, const LayoutType& own) {
  if (form.empty() && type.kind != Kind::kMatrix) return SameShape(type, own);
  if (FindTime(form) != nullptr)
    return own.kind == Kind::kNumber && own.number == Number::kF64 && type.kind == Kind::kNumber &&
           (type.number == Number::kU64 || type.number == Number::kI64);
  if (type.kind == Kind::kMatrix)
    return IsFloats(own) &&
           (form.empty() ? own.count == 3 || own.count == 7 || own.count == 9 : form == "inverse" && IsPose(own));
  const bool is_matrix = Has(form, "rows") || Has(form, "columns");
  const bool fits = is_matrix ? IsFloats(type) && (type.count == 12 || type.count == 16) : IsPose(type);
  constexpr std::array<std::string_view, 7> kForms = {"xyzw",         "columns",         "rows",        "inverse",
                                                      "inverse.xyzw", "inverse.columns", "inverse.rows"};
  return IsPose(own) && fits && std::ranges::find(kForms, form) != kForms.end();
}

std::string FormProblem(const LayoutMember& member, const LayoutType& own) {
  const std::string_view name = NameOf(member.name), form = FormOf(member.name);
  std::vector<LayoutMember> forms = OtherForms(name, own);
  for (const LayoutMember& half : kHalves)
    if (NameOf(half.name) == name) forms.push_back(half);
  std::erase_if(forms, [](const LayoutMember& other) { return FormOf(other.name).empty(); });
  if (form.empty() || forms.empty()) return {};  // forks call parts of their own like that, too
  std::string others, types;
  for (const LayoutMember& other : forms) {
    if (other == member) return {};
    if (other.name == member.name) types += (types.empty() ? "" : ", ") + other.type;
    const auto first = std::ranges::find(forms, other.name, &LayoutMember::name);
    if (&*first == &other) others += detail::Concat(others.empty() ? "" : ", ", FormOf(other.name));
  }
  if (IsForm(form, ParseLayoutType(member.type), own)) return {};
  if (!types.empty()) return detail::Concat(member.name, " is of type ", member.type, ", expected ", types);
  return detail::Concat("no form '", form, "' of ", name, "; forms are ", others);
}

bool SameWidths(const LayoutType& a, const LayoutType& b) {
  if (a.kind != b.kind || a.count != b.count || a.name != b.name || a.elements.size() != b.elements.size())
    return false;
  if (a.kind == Kind::kNumber) return Width(a.number) == Width(b.number) && IsReal(a.number) == IsReal(b.number);
  return std::equal(a.elements.begin(), a.elements.end(), b.elements.begin(), b.elements.end(), SameWidths);
}

std::uint64_t FixedBytes(const LayoutType& type) {
  if (type.kind == Kind::kNumber) return Width(type.number);
  return type.kind == Kind::kArray ? type.count * FixedBytes(type.elements[0]) : 0;
}

Numbers ToOwn(std::string_view form, Numbers numbers) {
  if (form.empty()) return numbers;
  if (const TimeForm* time = FindTime(form))
    return numbers.size() == 1 ? Numbers{numbers[0] / time->per_second} : Numbers();
  if (Has(form, "columns")) numbers = Transposed(numbers, 4);
  if (Has(form, "rows") && numbers.size() == 9) return Transposed(numbers, 3);
  if (Has(form, "rows") || Has(form, "columns")) numbers = PoseOfRows(numbers);
  if (numbers.size() != kPose) return {};
  if (Has(form, "xyzw")) std::rotate(numbers.begin(), numbers.begin() + 3, numbers.begin() + 4);
  return Has(form, "inverse") ? Inverse(numbers) : numbers;
}

Numbers FromOwn(std::string_view form, Numbers own, std::size_t count) {
  if (form.empty()) return own;
  if (const TimeForm* time = FindTime(form)) return {std::round(own[0] * time->per_second)};
  if (Has(form, "rows") && own.size() == 9) return Transposed(own, 3);
  if (own.size() != kPose) return {};
  if (Has(form, "inverse")) own = Inverse(own);
  if (Has(form, "xyzw")) std::rotate(own.begin(), own.begin() + 1, own.begin() + 4);
  if (!Has(form, "rows") && !Has(form, "columns")) return own;
  Numbers rows = RowsOfPose(own);
  rows.resize(count);
  return Has(form, "columns") ? Transposed(rows, count / 4) : rows;
}

std::string AsOwn(std::string_view form, const LayoutType& type, const LayoutType& own, std::string_view bytes,
                  std::uint64_t at) {
  Flattening flat(bytes, at);
  flat.Take(type);
  const bool is_matrix = type.kind == Kind::kMatrix && flat.numbers.size() != 3;
  const std::string full = is_matrix ? detail::Concat(form, form.empty() ? "" : ".", "rows") : std::string(form);
  const Numbers numbers = ToOwn(full, std::move(flat.numbers));
  if (numbers.empty() || (own.kind == Kind::kArray && numbers.size() != own.count)) return {};
  Writing writing(numbers);
  writing.Put(own);
  return std::move(writing.bytes);
}

}  // namespace slamdb::layouts
