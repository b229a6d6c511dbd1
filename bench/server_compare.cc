// SPDX-License-Identifier: BSD-3-Clause
#include "bench/server_compare.h"

#include <sys/resource.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <vector>

#include "bench/raw_copy.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/detail/schema.h"
#include "slamdb/formats/store/store.h"
#include "tests/support/postgresql_server.h"

namespace slamdb::bench {
namespace {

namespace fs = std::filesystem;
using Work = std::function<void()>;

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values.empty() ? 0 : values[values.size() / 2];
}

// ---- processor time

double OfThisProcess() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

std::string FirstLine(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

// The parent, behind the name in parentheses and the state.
std::string ParentOf(const fs::path& process) {
  const std::string line = FirstLine(process / "stat");
  const std::size_t at = line.rfind(") ");
  if (at == std::string::npos || line.size() < at + 5) return {};
  return line.substr(at + 4, line.find(' ', at + 4) - at - 4);
}

// By process, seconds, of all that a server has.
std::map<std::string, double> OfServer(const std::string& server) {
  std::map<std::string, double> times;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/proc", ignored)) {
    const std::string name = entry.path().filename();
    if (std::isdigit(static_cast<unsigned char>(name[0])) == 0 || ParentOf(entry.path()) != server) continue;
    times[name] = 1e-9 * std::atof(FirstLine(entry.path() / "schedstat").c_str());
  }
  return times;
}

struct Times {
  std::vector<double> wall, client, server;  // seconds
};

void Measure(const Work& work, const std::string& server, Times& times) {
  const std::map<std::string, double> server_before = OfServer(server);
  const double client_before = OfThisProcess();
  const auto start = std::chrono::steady_clock::now();
  work();
  times.wall.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  times.client.push_back(OfThisProcess() - client_before);
  double of_server = 0;
  for (const auto& [process, seconds] : OfServer(server)) {
    const auto before = server_before.find(process);
    of_server += seconds - (before == server_before.end() ? 0 : before->second);
  }
  times.server.push_back(of_server);
}

// ---- the table

// `before` is not measured.
struct Side {
  Work before, work;
};

class Table {
 public:
  Table(std::string server, int rounds) : server_(std::move(server)), rounds_(rounds) {
    std::cout << "| | ms | client + server | beside it | client + server | times as long |\n|---|---|---|---|---|---|\n"
              << std::setprecision(3);
  }

  void Row(const std::string& what, const Side& first, const Side& second) const {
    Times ours, theirs;
    std::vector<double> ratios;
    const auto run = [&](const Side& side, Times& times) {
      if (side.before) side.before();
      Measure(side.work, server_, times);
    };
    for (int round = 0; round < rounds_; ++round) {
      round % 2 == 0 ? run(first, ours) : run(second, theirs);
      round % 2 == 0 ? run(second, theirs) : run(first, ours);
      ratios.push_back(ours.wall.back() / theirs.wall.back());
    }
    std::cout << "| " << what << Cells(ours) << Cells(theirs) << " | " << Median(ratios) << " ("
              << std::ranges::min(ratios) << " to " << std::ranges::max(ratios) << ") |\n"
              << std::flush;
  }

 private:
  static std::string Cells(const Times& times) {
    std::ostringstream out;
    out << std::setprecision(3) << " | " << 1e3 * Median(times.wall) << " | " << 1e3 * Median(times.client) << " + "
        << 1e3 * Median(times.server);
    return out.str();
  }

  std::string server_;  // its process
  int rounds_;
};

}  // namespace

Atlas Changed(Atlas atlas, int round) {
  const float way = 0.01F * static_cast<float>(round + 1);
  for (Map& map : atlas.maps) {
    for (std::size_t i = 0; i < map.keyframes.size(); i += 100) {
      KeyFrame& keyframe = map.keyframes[i];
      keyframe.camera_from_world.translation.x() += way;
      auto& points = keyframe.features.map_points;
      if (!points.empty()) points[static_cast<std::size_t>(round) % points.size()] = MapPointId();
    }
    for (std::size_t i = 0; i < map.points.size(); i += 100) map.points[i].position.x() += way;
  }
  return atlas;
}

namespace {

void SaveIn(const std::string& where, const Atlas& what) {
  Store::OpenForWriting(where, {.sync = false}).Save("a", what);
}

// A database with the tables of a store, which are made once for all atlases.
class Database {
 public:
  Database(PostgresqlServer& server, int partitions) : server_(server), name_(server.MakeDatabase()) {
    postgresql::Connection connection(uri());
    postgresql::MakeStore(connection, partitions);
    Store::OpenForWriting(uri());  // whose connection is kept, as that of a program which saves more than once
  }
  // So that its pages do not stand in the way of others.
  ~Database() { postgresql::Connection(server_.Uri("postgres")).Execute("DROP DATABASE " + name_ + " WITH (FORCE)"); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  std::string uri() const { return server_.Uri(name_); }

 private:
  PostgresqlServer& server_;
  std::string name_;
};

}  // namespace

int CompareStores(const std::string& path, int rounds) {
  const Atlas atlas = ReadAtlas(path);
  PostgresqlServer server("shared_buffers = 256MB\nmax_wal_size = 4GB\nfull_page_writes = off");
  const std::string file = fs::temp_directory_path() / "slamdb_server_bench.db";
  const Table table(FirstLine(fs::path(server.folder()) / "data/postmaster.pid"), rounds);
  std::unique_ptr<Database> one, other;
  const auto make = [&server](std::unique_ptr<Database>& database, int partitions) {
    database.reset();
    database = std::make_unique<Database>(server, partitions);
  };
  const auto make_one = [&] { make(one, 1); };
  const auto remove_file = [&] { fs::remove(file); };
  table.Row("save; a file", {make_one, [&] { SaveIn(one->uri(), atlas); }},
            {remove_file, [&] { SaveIn(file, atlas); }});
  table.Row("load; a file", {{}, [&] { Store::Open(one->uri()).Load("a"); }},
            {{}, [&] { Store::Open(file).Load("a"); }});
  int round = 0;
  Atlas changed;
  const auto change = [&] { changed = Changed(atlas, round++); };
  table.Row("save after 1 %; a file", {change, [&] { SaveIn(one->uri(), changed); }},
            {change, [&] { SaveIn(file, changed); }});
  table.Row("save of what is there; a file", {[&] { SaveIn(one->uri(), atlas); }, [&] { SaveIn(one->uri(), atlas); }},
            {[&] { SaveIn(file, atlas); }, [&] { SaveIn(file, atlas); }});
  table.Row("load of an earlier revision; a file", {{}, [&] { Store::Open(one->uri()).Load("a@1"); }},
            {{}, [&] { Store::Open(file).Load("a@1"); }});
  table.Row("list; a file", {{}, [&] { Store::Open(one->uri()).List(); }}, {{}, [&] { Store::Open(file).List(); }});
  table.Row("load; COPY of the same rows", {{}, [&] { Store::Open(one->uri()).Load("a"); }},
            {{}, [&] { CopyRawOut(one->uri(), false); }});
  const std::vector<RawRows> raw = CopyRawOut(one->uri(), true);
  table.Row("save; COPY of the same rows", {make_one, [&] { SaveIn(one->uri(), atlas); }},
            {[&] { make(other, 1); }, [&] { CopyRawIn(other->uri(), raw); }});
  table.Row("save in three partitions; in one", {[&] { make(other, 3); }, [&] { SaveIn(other->uri(), atlas); }},
            {make_one, [&] { SaveIn(one->uri(), atlas); }});
  table.Row("load from three partitions; from one", {{}, [&] { Store::Open(other->uri()).Load("a"); }},
            {{}, [&] { Store::Open(one->uri()).Load("a"); }});
  remove_file();
  return 0;
}

}  // namespace slamdb::bench
