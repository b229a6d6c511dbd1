// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/codec.h"
#include "slamdb/formats/colmap/detail/lenses.h"
#include "slamdb/formats/colmap/detail/poses.h"

namespace slamdb::colmap {
namespace {

using detail::Concat;

constexpr std::string_view kSeparators = " \t";

// The lines of one file, and the words of the line that it is at.
class Lines {
 public:
  explicit Lines(const WholeFile& file) : file_(file), rest_(detail::WithoutMark(file.text())) {}

  // Goes to the next line that is neither blank nor a comment; false when there is none.
  bool Next() {
    while (!rest_.empty()) {
      NextAsItIs();
      line_ = detail::Trimmed(line_);
      if (line_.starts_with('#'))
        TakeComment();
      else if (!line_.empty())
        return true;
    }
    return false;
  }
  // Goes to the next line, whatever it is; an empty one behind the end.
  void NextAsItIs() {
    line_ = detail::TakeLine(rest_);
    ++number_;
  }

  // The next word of the line; empty at its end.
  std::string_view Word() { return detail::TakeWord(line_, kSeparators); }
  std::string_view Need(std::string_view what) {
    const std::string_view word = Word();
    if (word.empty()) Fail(Concat("the line ends where ", what, " is expected"));
    return word;
  }
  template <class Number>
  Number Take(std::string_view what) {
    return As<Number>(Need(what), what);
  }
  template <class Number>
  Number As(std::string_view word, std::string_view what) const {
    if (const auto number = detail::ParseNumber<Number>(word)) return *number;
    Fail(Concat("expected ", what, ", found ", detail::Excerpt(word)));
  }
  template <class Numbers>
  void TakeAll(Numbers& numbers, std::string_view what) {
    for (auto& number : numbers) number = Take<typename Numbers::value_type>(what);
  }
  Pose TakePose() {
    Pose pose;
    TakeAll(pose.wxyz, "a quaternion");
    TakeAll(pose.translation, "a translation");
    Require(WhyNoPose(pose));
    return pose;
  }
  Sensor TakeSensor() {
    const std::string_view type = Need("a type of sensor");
    Sensor sensor;
    if (type == "CAMERA")
      sensor.type = SensorType::kCamera;
    else if (type == "IMU")
      sensor.type = SensorType::kImu;
    else if (type == "INVALID")
      sensor.type = SensorType::kInvalid;
    else
      Fail(Concat("there is no sensor of type ", detail::Excerpt(type)));
    sensor.id = Take<std::uint32_t>("a sensor's id");
    return sensor;
  }
  void End() {
    if (const std::string_view word = Word(); !word.empty())
      Fail(Concat("too much in the line: ", detail::Excerpt(word)));
  }
  // Holds what was read against what the head promises: `# Number of images: 14, ...`. More is no sign of damage.
  void EndAfter(std::uint64_t entries) const {
    if (!promised_ || entries >= *promised_) return;
    throw Error(ErrorKind::kDamaged, file_.path(), Concat("line ", number_),
                Concat("the file ends after ", entries, " of the ", *promised_,
                       " entries that its head counts: it is truncated; copy it again"));
  }
  // How many words of at least one letter the rest of the line can hold.
  std::size_t most_words() const { return line_.size() / 2 + 1; }
  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(ErrorKind::kDamaged, file_.path(), Concat("line ", number_), problem);
  }
  void Require(const std::string& why_not) const {
    if (!why_not.empty()) Fail(why_not);
  }

 private:
  void TakeComment() {
    const std::size_t name = line_.find(kCountIs), end = line_.find(": ");
    if (promised_ || name == line_.npos || end == line_.npos) return;
    const std::string_view count = line_.substr(end + 2);
    promised_ = detail::ParseNumber<std::uint64_t>(count.substr(0, count.find(',')));
  }

  static constexpr std::string_view kCountIs = "# Number of ";
  const WholeFile& file_;
  std::string_view rest_, line_;
  std::size_t number_ = 0;
  std::optional<std::uint64_t> promised_;
};

void TakeCamera(Lines& lines, Model& model) {
  Camera& camera = model.cameras.emplace_back();
  camera.id = lines.Take<std::uint32_t>("a camera's id");
  const std::string_view name = lines.Need("a camera model");
  const auto* known = std::ranges::find(kCameraModels, name, &CameraModelName::name);
  if (known == kCameraModels.end()) lines.Fail(Concat("there is no camera model ", detail::Excerpt(name)));
  camera.model = static_cast<std::int32_t>(known - kCameraModels.begin());
  camera.width = lines.Take<std::uint64_t>("a width");
  camera.height = lines.Take<std::uint64_t>("a height");
  camera.parameters.resize(known->parameters);
  lines.TakeAll(camera.parameters, Concat("one of ", known->parameters, " parameters"));
  lines.Require(WhyNoCamera(camera));
  lines.End();
}

void TakeImage(Lines& lines, Model& model) {
  Image& image = model.images.emplace_back();
  image.id = lines.Take<std::uint32_t>("an image's id");
  image.camera_from_world = lines.TakePose();
  image.camera = lines.Take<std::uint32_t>("a camera's id");
  image.name = lines.Need("a name");
  lines.End();
  lines.NextAsItIs();
  constexpr std::size_t kLettersOfPoint = 6;
  image.points.reserve(lines.most_words() * 2 / kLettersOfPoint + 1);
  for (std::string_view x = lines.Word(); !x.empty(); x = lines.Word()) {
    Point2 point{.x = lines.As<double>(x, "a keypoint"), .y = lines.Take<double>("a keypoint")};
    const std::string_view id = lines.Need("a point's id");
    if (id != "-1") point.point = lines.As<std::uint64_t>(id, "a point's id");
    image.points.push_back(point);
  }
}

void TakePoint(Lines& lines, Model& model) {
  Point& point = model.points.emplace_back();
  point.id = lines.Take<std::uint64_t>("a point's id");
  lines.TakeAll(point.position, "a position");
  lines.Require(WhyNoPosition(point));
  lines.TakeAll(point.color, "a colour");
  point.error = lines.Take<double>("an error");
  point.track_begin = model.tracks.size();
  for (std::string_view image = lines.Word(); !image.empty(); image = lines.Word())
    model.tracks.push_back({lines.As<std::uint32_t>(image, "an image's id"), lines.Take<std::uint32_t>("a keypoint")});
  point.track_length = model.tracks.size() - point.track_begin;
}

void TakeRig(Lines& lines, Model& model) {
  Rig& rig = model.rigs.emplace_back();
  rig.id = lines.Take<std::uint32_t>("a rig's id");
  const auto count = lines.Take<std::uint32_t>("a number of sensors");
  if (count > lines.most_words()) lines.Fail(Concat("a count of ", count, " sensors does not fit into the line"));
  rig.sensors.resize(count);
  for (std::size_t row = 0; row < count; ++row) {
    rig.sensors[row].sensor = lines.TakeSensor();
    if (row > 0 && lines.Take<int>("whether there is a pose") != 0) rig.sensors[row].sensor_from_rig = lines.TakePose();
  }
  lines.End();
}

void TakeFrame(Lines& lines, Model& model) {
  Frame& frame = model.frames.emplace_back();
  frame.id = lines.Take<std::uint32_t>("a frame's id");
  frame.rig = lines.Take<std::uint32_t>("a rig's id");
  frame.rig_from_world = lines.TakePose();
  const auto count = lines.Take<std::uint32_t>("a number of images");
  if (count > lines.most_words()) lines.Fail(Concat("a count of ", count, " images does not fit into the line"));
  frame.data.resize(count);
  for (FrameData& data : frame.data) {
    data.sensor = lines.TakeSensor();
    data.data = lines.Take<std::uint64_t>("an image's id");
  }
  lines.End();
}

}  // namespace

void DecodeText(Part part, const WholeFile& file, Model& model) {
  constexpr std::array kTake = {TakeCamera, TakeImage, TakePoint, TakeRig, TakeFrame};
  Lines lines(file);
  std::uint64_t entries = 0;
  for (; lines.Next(); ++entries) kTake[static_cast<std::size_t>(part)](lines, model);
  lines.EndAfter(entries);
}

}  // namespace slamdb::colmap
