// SPDX-License-Identifier: BSD-3-Clause
#include "tests/formats/orbslam2/graph_encoder.h"

#include <cstring>
#include <functional>
#include <initializer_list>
#include <map>
#include <string_view>
#include <unordered_map>

namespace slamdb {
namespace {

using Kind = GraphField::Kind;

class Encoder {
 public:
  Encoder(const Map& map, std::size_t words) : map_(map), words_(words) {
    for (const KeyFrame& keyframe : map.keyframes) keyframes_[keyframe.id.value()] = &keyframe;
    for (const MapPoint& point : map.points) points_[point.id.value()] = &point;
  }

  EncodedGraph Encode() {
    Do({[this] { Pointer("Map", &map_, [this] { MapBody(); }); },
        [this] { Pointer("KeyFrameDatabase", &words_, [this] { DatabaseBody(); }); }});
    while (!tasks_.empty()) {
      const Task task = std::move(tasks_.back());
      tasks_.pop_back();
      task();
    }
    return std::move(encoded_);
  }

 private:
  using Task = std::function<void()>;

  // What is to be done next, in this order: a stack in place of recursion, as deep as the map is large.
  void Do(std::initializer_list<Task> tasks) {
    for (auto task = tasks.end(); task != tasks.begin();) tasks_.push_back(*--task);
  }
  // element(0), element(1), ... each with what it begins, one behind the other.
  void Each(std::size_t count, std::function<void(std::size_t)> element, std::size_t at = 0) {
    if (at == count) return;
    Do({[=] { element(at); }, [=, this] { Each(count, element, at + 1); }});
  }

  // ---- tokens

  template <class Number>
  void Put(Number number) {
    encoded_.bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  template <class Number>
  void Put(Kind kind, Number number) {
    encoded_.fields.push_back({kind, encoded_.bytes.size(), sizeof number});
    Put(number);
  }
  template <class Number>
  void PutAll(std::initializer_list<Number> numbers) {
    for (const Number number : numbers) Put(number);
  }
  std::int16_t Register(const std::string& name) {
    return ids_.emplace(name, static_cast<std::int16_t>(ids_.size())).first->second;
  }
  void Info(const std::string& name, std::uint8_t tracking = 0) {
    Register(name);
    if (!informed_.emplace(name, true).second) return;
    Put(Kind::kVersion, tracking);
    Put(Kind::kVersion, std::uint32_t{0});
  }
  void Collection(const std::string& name, std::size_t count) {
    Info(name);
    Put(Kind::kCount, std::uint64_t{count});
    Put(Kind::kVersion, std::uint32_t{0});
  }
  template <class Numbers>
  void Vector(const std::string& name, const Numbers& numbers) {
    Register(name);
    Put(Kind::kCount, std::uint64_t{numbers.size()});
    for (const auto number : numbers) Put(number);
  }
  void Pointer(const std::string& name, const void* object, Task body) {
    Register(name);
    if (object == nullptr) return Put(Kind::kClass, std::int16_t{-1});
    Put(Kind::kClass, Register(name));
    Info(name, 1);
    const auto [it, is_new] = objects_.emplace(object, static_cast<std::uint32_t>(objects_.size()));
    Put(Kind::kObject, it->second);
    if (is_new) Do({std::move(body)});
  }
  void KeyFramePointer(KeyFrameId id) {
    const auto found = keyframes_.find(id.value());
    const KeyFrame* keyframe = found == keyframes_.end() ? nullptr : found->second;
    Pointer("KeyFrame", keyframe, [=, this] { KeyFrameBody(*keyframe); });
  }
  void PointPointer(MapPointId id) {
    const auto found = points_.find(id.value());
    const MapPoint* point = found == points_.end() ? nullptr : found->second;
    Pointer("MapPoint", point, [=, this] { PointBody(*point); });
  }
  void MapPointer() { Pointer("Map", &map_, {}); }
  void Mat(std::int32_t rows, std::int32_t columns, std::uint64_t element, std::uint64_t type, const void* data) {
    Info("Mat");
    Put(Kind::kMatrix, columns);
    Put(Kind::kMatrix, rows);
    Put(Kind::kMatrix, element);
    Put(Kind::kMatrix, type);
    if (rows * columns > 0)
      encoded_.bytes.append(static_cast<const char*>(data),
                            static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns) * element);
  }
  void EmptyMat() { Mat(0, 0, 0, 0, nullptr); }
  void FloatMat(std::int32_t rows, std::int32_t columns, const float* data) { Mat(rows, columns, 4, 5, data); }
  void PoseMat(const Rigid3f& pose) {
    Eigen::Matrix<float, 4, 4, Eigen::RowMajor> matrix = Eigen::Matrix4f::Identity();
    matrix.topLeftCorner<3, 3>() = Eigen::Quaternionf(pose.rotation).toRotationMatrix();
    matrix.topRightCorner<3, 1>() = pose.translation;
    FloatMat(4, 4, matrix.data());
  }
  void Keypoints(const Column<Keypoint>& keypoints) {
    Collection("vector<KeyPoint>", keypoints.size());
    for (const Keypoint& keypoint : keypoints) {
      Info("KeyPoint");
      Put(keypoint.angle);
      PutAll({keypoint.class_id, keypoint.octave});
      PutAll({keypoint.response, keypoint.response, keypoint.x, keypoint.y});
    }
  }

  // ---- classes

  void MapBody() {
    Do({[this] { Collection("set<MapPoint*>", map_.points.size()); },
        [this] { Each(map_.points.size(), [this](std::size_t i) { PointPointer(map_.points[i].id); }); },
        [this] { Collection("vector<KeyFrame*>", map_.origins.size()); },
        [this] { Each(map_.origins.size(), [this](std::size_t i) { KeyFramePointer(map_.origins[i]); }); },
        [this] { Collection("set<KeyFrame*>", map_.keyframes.size()); },
        [this] { Each(map_.keyframes.size(), [this](std::size_t i) { KeyFramePointer(map_.keyframes[i].id); }); },
        [this] { Collection("vector<MapPoint*>", map_.points.size()); },
        [this] { Each(map_.points.size(), [this](std::size_t i) { PointPointer(map_.points[i].id); }); },
        [this] {
          Put(map_.max_keyframe_id);
          Put(map_.big_change_index);
        }});
  }

  void PointHead(const MapPoint& point) {
    PutAll<std::uint64_t>({point.id.value(), map_.points.size() + 1000});
    PutAll({point.first_keyframe, point.first_frame});
    Put(point.observation_count);
    PutAll({1.F, 2.F, 3.F});
    Put(std::uint8_t{1});
    Put(std::int32_t{2});
    Put(0.5F);
    for (std::uint64_t i = 0; i < 7; ++i) Put(i);
    EmptyMat();
    Put(std::uint64_t{0});
    FloatMat(3, 1, point.position.data());
    Collection("map<KeyFrame*,u64>", point.observations.size());
  }
  void PointTail(const MapPoint& point) {
    PutAll({point.visible_count, point.found_count});
    Put(point.bad.recorded);
  }
  void PointBody(const MapPoint& point) {
    Do({[&point, this] { PointHead(point); },
        [&point, this] {
          Each(point.observations.size(), [&point, this](std::size_t i) {
            Info("pair<KeyFrame*,u64>");
            Do({[&point, i, this] { KeyFramePointer(point.observations[i].keyframe); },
                [&point, i, this] { Put(static_cast<std::uint64_t>(point.observations[i].left)); }});
          });
        },
        [&point, this] {
          FloatMat(3, 1, point.normal.data());
          if (point.has_descriptor())
            Mat(1, 32, 1, 0, point.descriptor.data());
          else
            EmptyMat();
        },
        [&point, this] { KeyFramePointer(point.reference); }, [&point, this] { PointTail(point); },
        [&point, this] { PointPointer(point.replaced_by); },
        [&point, this] {
          PutAll({point.min_distance, point.max_distance});
          MapPointer();
        }});
  }

  void KeyFrameHead(const KeyFrame& keyframe) {
    const ImageBounds& bounds = keyframe.bounds;
    PutAll<std::uint64_t>({map_.keyframes.size() + 1000, keyframe.id.value(), keyframe.frame_id});
    Put(keyframe.timestamp);
    PutAll({bounds.grid_columns, bounds.grid_rows});
    PutAll({bounds.inverse_cell_width, bounds.inverse_cell_height});
    for (std::uint64_t i = 0; i < 4; ++i) Put(i);
    for (int query = 0; query < 2; ++query) {
      Put(std::uint64_t{7});
      Put(std::int32_t{8});
      Put(0.25F);
    }
    EmptyMat();
    EmptyMat();
    Put(std::uint64_t{0});
    const Intrinsics& it = keyframe.intrinsics;
    PutAll({it.fx, it.fy, it.cx, it.cy, it.inverse_fx, it.inverse_fy, it.baseline_fx, it.baseline, it.depth_threshold});
  }
  void KeyFrameFeatures(const Features& features) {
    Put(features.count);
    Keypoints(features.keypoints);
    Keypoints(features.undistorted);
    Vector("vector<float>", features.right_x);
    Vector("vector<float>", features.depth);
    Mat(static_cast<std::int32_t>(features.descriptors.size()), features.descriptors.empty() ? 0 : 32, 1, 0,
        features.descriptors.data());
    Info("BowVector");
    Collection("map<u32,f64>", features.bag_of_words.words.size());
    for (std::size_t i = 0; i < features.bag_of_words.words.size(); ++i) {
      Info("pair<u32,f64>");
      Put(features.bag_of_words.words[i]);
      Put(features.bag_of_words.weights[i]);
    }
    Info("FeatureVector");
    const FeatureVector& vector = features.feature_vector;
    Collection("map<u32,vector<u32>>", vector.nodes.size());
    auto next = vector.features.begin();
    for (std::size_t i = 0; i < vector.nodes.size(); ++i) {
      Info("pair<u32,vector<u32>>");
      Put(vector.nodes[i]);
      Vector("vector<u32>", std::vector<std::uint32_t>(next, next + vector.sizes[i]));
      next += vector.sizes[i];
    }
  }
  void KeyFramePoses(const KeyFrame& keyframe) {
    PoseMat(keyframe.camera_from_parent);
    const ScalePyramid& pyramid = keyframe.pyramid;
    Put(pyramid.levels);
    PutAll({pyramid.factor, pyramid.log_factor});
    for (const auto* table : {&pyramid.factors, &pyramid.sigma2, &pyramid.inverse_sigma2})
      Vector("vector<float>", *table);
    const ImageBounds& bounds = keyframe.bounds;
    PutAll({bounds.min_x, bounds.min_y, bounds.max_x, bounds.max_y});
    const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> calibration = keyframe.calibration_matrix;
    FloatMat(3, 3, calibration.data());
    const Rigid3f world_from_camera = keyframe.camera_from_world.Inverse();
    PoseMat(keyframe.camera_from_world);
    PoseMat(world_from_camera);
    FloatMat(3, 1, world_from_camera.translation.data());
    const Eigen::Vector4f center(0, 0, 0, 1);
    FloatMat(4, 1, center.data());
    Collection("vector<MapPoint*>", keyframe.features.map_points.size());
  }
  void Grid(const FeatureGrid& grid) {
    Collection("vector<vector<vector<u64>>>", grid.column_sizes.size());
    std::size_t cell = 0;
    auto next = grid.keypoints.begin();
    for (const std::uint32_t cells : grid.column_sizes) {
      Collection("vector<vector<u64>>", cells);
      for (const std::size_t end = cell + cells; cell < end; ++cell) {
        Vector("vector<u64>", std::vector<std::uint64_t>(next, next + grid.cell_sizes[cell]));
        next += grid.cell_sizes[cell];
      }
    }
  }
  template <class Links>
  void KeyFrameList(const std::string& name, const Links& links) {
    Do({[&links, name, this] { Collection(name, links.size()); },
        [&links, this] { Each(links.size(), [&links, this](std::size_t i) { KeyFramePointer(links[i]); }); }});
  }
  void Connections(const Column<Connection>& connections) {
    Do({[&connections, this] { Collection("map<KeyFrame*,i32>", connections.size()); },
        [&connections, this] {
          Each(connections.size(), [&connections, this](std::size_t i) {
            Info("pair<KeyFrame*,i32>");
            Do({[&connections, i, this] { KeyFramePointer(connections[i].keyframe); },
                [&connections, i, this] { Put(connections[i].weight); }});
          });
        },
        [&connections, this] { Collection("vector<KeyFrame*>", connections.size()); },
        [&connections, this] {
          Each(connections.size(), [&connections, this](std::size_t i) { KeyFramePointer(connections[i].keyframe); });
        },
        [&connections, this] {
          std::vector<std::int32_t> weights;
          for (const Connection& connection : connections) weights.push_back(connection.weight);
          Vector("vector<i32>", weights);
        }});
  }
  void KeyFrameBody(const KeyFrame& keyframe) {
    Do({[&keyframe, this] {
          KeyFrameHead(keyframe);
          KeyFrameFeatures(keyframe.features);
          KeyFramePoses(keyframe);
        },
        [&keyframe, this] {
          const Column<MapPointId>& points = keyframe.features.map_points;
          Each(points.size(), [&points, this](std::size_t i) { PointPointer(points[i]); });
        },
        [this] { Pointer("KeyFrameDatabase", &words_, [this] { DatabaseBody(); }); },
        [&keyframe, this] {
          Grid(keyframe.features.grid);
          Connections(keyframe.connections);
        },
        [&keyframe, this] {
          Put(keyframe.first_connection.recorded);
          KeyFramePointer(keyframe.parent);
        },
        [&keyframe, this] { KeyFrameList("set<KeyFrame*>", keyframe.children); },
        [&keyframe, this] { KeyFrameList("set<KeyFrame*>", keyframe.loop_edges); },
        [&keyframe, this] {
          PutAll({keyframe.not_erase.recorded, keyframe.to_be_erased.recorded, keyframe.bad.recorded});
          Put(keyframe.half_baseline);
          MapPointer();
        }});
  }

  // Word w is in keyframe w alone.
  void DatabaseBody() {
    Do({[this] { Collection("vector<list<KeyFrame*>>", words_); },
        [this] {
          Each(words_, [this](std::size_t word) {
            const std::size_t size = word < map_.keyframes.size() ? 1 : 0;
            Collection("list<KeyFrame*>", size);
            if (size > 0) KeyFramePointer(map_.keyframes[word].id);
          });
        }});
  }

  const Map& map_;
  const std::size_t words_;
  std::unordered_map<std::uint64_t, const KeyFrame*> keyframes_;
  std::unordered_map<std::uint64_t, const MapPoint*> points_;
  std::map<std::string, std::int16_t> ids_;
  std::map<std::string, bool> informed_;
  std::unordered_map<const void*, std::uint32_t> objects_;
  std::vector<Task> tasks_;
  EncodedGraph encoded_;
};

}  // namespace

EncodedGraph EncodeGraph(const Map& map, std::size_t words) { return Encoder(map, words).Encode(); }

}  // namespace slamdb
