// SPDX-License-Identifier: BSD-3-Clause
#include "tests/view/page_data.h"

#include <zlib.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace slamdb::testing {
namespace {

std::string BytesOfBase64(std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char letter : text) {
    if (letter == '=') break;
    const std::size_t digit = kDigits.find(letter);
    if (digit == std::string_view::npos) throw std::runtime_error("a letter that is not of base64");
    bits = bits << 6 | static_cast<unsigned>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<char>(bits >> count & 255));
  }
  return bytes;
}

std::string Inflated(const std::string& packed) {
  std::string bytes(std::size_t{4} << 20, '\0');
  uLongf size = bytes.size();
  if (uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(packed.data()),
                 packed.size()) != Z_OK)
    throw std::runtime_error("a part that zlib does not take, or larger than 4 MiB");
  bytes.resize(size);
  return bytes;
}

std::int64_t Signed(std::uint64_t zigzag) {
  return static_cast<std::int64_t>(zigzag >> 1) ^ -static_cast<std::int64_t>(zigzag & 1);
}

template <class Number>
Number At(std::string_view bytes, std::size_t offset) {
  Number number;
  std::memcpy(&number, bytes.substr(offset, sizeof(Number)).data(), sizeof(Number));
  return number;
}

// How many rows each block of points has.
std::vector<std::size_t> BlockSizes(const nlohmann::json& header) {
  std::vector<std::size_t> sizes;
  for (const auto& atlas : header.at("atlases"))
    for (const auto& map : atlas.at("maps"))
      for (std::size_t left = map.at("points"); left > 0; left -= sizes.back())
        sizes.push_back(std::min<std::size_t>(left, 4096));
  return sizes;
}

}  // namespace

PageData::PageData(const std::string& html) {
  constexpr std::string_view kBegin = "<script type=\"text/plain\" data-name=\"", kMiddle = "\" data-part=\"";
  for (std::size_t at = html.find(kBegin); at != std::string::npos; at = html.find(kBegin, at)) {
    at += kBegin.size();
    const std::size_t name_end = html.find(kMiddle, at), part = name_end + kMiddle.size();
    const std::size_t text = html.find('>', part) + 1, end = html.find("</script>", text);
    const std::string name = html.substr(at, name_end - at);
    order.push_back(name + "/" + html.substr(part, text - part - 2));
    columns[name] += Inflated(BytesOfBase64(std::string_view(html).substr(text, end - text)));
    at = end;
  }
  header = nlohmann::json::parse(columns.at("header"));
}

std::string_view PageData::Bytes(const std::string& name) const {
  const auto found = columns.find(name);
  return found == columns.end() ? std::string_view() : std::string_view(found->second);
}

std::vector<std::uint64_t> PageData::Varints(const std::string& name) const {
  std::vector<std::uint64_t> values;
  std::uint64_t value = 0;
  int shift = 0;
  for (const char byte : Bytes(name)) {
    value |= static_cast<std::uint64_t>(byte & 127) << shift;
    shift += 7;
    if ((byte & 128) != 0) continue;
    values.push_back(value);
    value = 0;
    shift = 0;
  }
  if (shift != 0) throw std::runtime_error(name + " ends inside of a number");
  return values;
}

std::vector<std::uint64_t> PageData::Differences(const std::string& name) const {
  std::vector<std::uint64_t> values = Varints(name);
  std::uint64_t last = 0;
  for (std::uint64_t& value : values) value = last += static_cast<std::uint64_t>(Signed(value));
  return values;
}

std::vector<std::uint8_t> PageData::OneByte(const std::string& name) const {
  const std::string_view bytes = Bytes(name);
  return {bytes.begin(), bytes.end()};
}

std::vector<Eigen::Vector3d> PageData::Positions(std::vector<Eigen::Vector3d>* steps) const {
  const std::size_t rows = Bytes("points/x").size() / 2;
  std::vector<Eigen::Vector3d> positions(rows);
  if (steps != nullptr) steps->assign(rows, Eigen::Vector3d::Zero());
  std::size_t first = 0, block = 0;
  for (const std::size_t count : BlockSizes(header)) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view bytes = Bytes(std::string("points/") + "xyz"[axis]).substr(2 * first, 2 * count);
      const float origin = At<float>(Bytes("points/frame"), 24 * block + 4 * axis);
      const float step = At<float>(Bytes("points/frame"), 24 * block + 12 + 4 * axis);
      std::uint16_t value = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const auto low = static_cast<std::uint8_t>(bytes[i]), high = static_cast<std::uint8_t>(bytes[count + i]);
        value = static_cast<std::uint16_t>(value + (low | high << 8));
        positions[first + i][axis] = double{origin} + double{step} * value;
        if (steps != nullptr) (*steps)[first + i][axis] = step;
      }
    }
    first += count;
    ++block;
  }
  const std::vector<std::uint64_t> far = Differences("points/far_row");
  for (std::size_t i = 0; i < far.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) positions.at(far[i])[axis] = At<float>(Bytes("points/far"), 12 * i + 4 * axis);
    if (steps != nullptr) (*steps)[far[i]].setZero();
  }
  return positions;
}

std::vector<std::vector<std::int64_t>> PageData::Seen() const {
  const std::vector<std::uint64_t> values = Varints("points/seen");
  std::vector<std::vector<std::int64_t>> seen;
  std::int64_t last_first = 0;
  for (std::size_t at = 0; at < values.size();) {
    std::vector<std::int64_t>& rows = seen.emplace_back();
    const std::uint64_t count = values[at++];
    for (std::uint64_t i = 0; i < count; ++i) {
      if (i == 0)
        rows.push_back(last_first += Signed(values.at(at++)));
      else
        rows.push_back(rows.back() + static_cast<std::int64_t>(values.at(at++)));
    }
  }
  return seen;
}

std::vector<std::int64_t> PageData::References() const {
  const std::vector<std::uint64_t> rows = Differences("points/reference");
  return {rows.begin(), rows.end()};
}

std::vector<double> PageData::Errors() const {
  std::vector<double> errors;
  for (const std::uint8_t value : OneByte("points/error"))
    errors.push_back(value == 0 ? std::numeric_limits<double>::quiet_NaN()
                                : header.at("error_max").get<double>() * std::pow((value - 1) / 254.0, 2));
  return errors;
}

std::vector<double> PageData::Times() const {
  std::vector<double> times;
  for (std::size_t i = 0; i < keyframes(); ++i) times.push_back(At<double>(Bytes("keyframes/time"), 8 * i));
  return times;
}

std::vector<std::array<float, 7>> PageData::Poses() const {
  std::vector<std::array<float, 7>> poses;
  for (std::size_t i = 0; i < keyframes(); ++i)
    poses.push_back(At<std::array<float, 7>>(Bytes("keyframes/pose"), 28 * i));
  return poses;
}

std::vector<std::int64_t> PageData::Parents() const {
  std::vector<std::int64_t> parents;
  for (const std::uint64_t value : Varints("keyframes/parent"))
    parents.push_back(static_cast<std::int64_t>(parents.size()) + Signed(value));
  return parents;
}

std::vector<CovisibilityOfPage> PageData::Covisibility() const {
  const std::vector<std::uint64_t> values = Varints("edges/covisibility");
  std::vector<CovisibilityOfPage> edges;
  std::int64_t row = 0;
  for (std::size_t at = 0; at < values.size(); ++row) {
    std::int64_t other = row;
    for (std::uint64_t left = values[at++]; left > 0; --left) {
      other += static_cast<std::int64_t>(values.at(at++));
      edges.push_back({row, other, values.at(at++)});
    }
  }
  return edges;
}

std::vector<std::pair<std::int64_t, std::int64_t>> PageData::Pairs(const std::string& name) const {
  const std::vector<std::uint64_t> values = Varints(name);
  std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
  std::int64_t first = 0;
  for (std::size_t at = 0; at < values.size(); at += 2) {
    first += Signed(values[at]);
    pairs.emplace_back(first, first + Signed(values.at(at + 1)));
  }
  return pairs;
}

std::vector<std::vector<KeypointOfPage>> PageData::Keypoints() const {
  std::vector<std::vector<KeypointOfPage>> keypoints;
  const std::vector<std::uint64_t> points = Varints("keypoints/point");
  std::size_t at = 0;
  for (const std::uint64_t count : Varints("keypoints/count")) {
    std::vector<KeypointOfPage>& mine = keypoints.emplace_back();
    std::int64_t point = 0;
    for (std::uint64_t i = 0; i < count; ++i, ++at)
      mine.push_back({At<std::uint16_t>(Bytes("keypoints/x"), 2 * at) / 8.0,
                      At<std::uint16_t>(Bytes("keypoints/y"), 2 * at) / 8.0, point += Signed(points.at(at))});
  }
  return keypoints;
}

ViewPage PageOf(const Atlas& atlas, const ViewOptions& options) {
  const ViewInput input{.atlas = &atlas, .name = "atlas.osa", .format = "test", .facts = {}};
  return MakeViewPage({&input, 1}, options);
}

PageData DataOf(const Atlas& atlas, const ViewOptions& options) { return PageData(PageOf(atlas, options).html); }

PageData DataOf(const std::vector<const Atlas*>& atlases, const ViewOptions& options) {
  std::vector<ViewInput> inputs;
  for (const Atlas* atlas : atlases)
    inputs.push_back({.atlas = atlas, .name = "atlas " + std::to_string(inputs.size()), .format = {}, .facts = {}});
  return PageData(MakeViewPage(inputs, options).html);
}

}  // namespace slamdb::testing
