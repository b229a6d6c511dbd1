// SPDX-License-Identifier: BSD-3-Clause
// slamdb_server_bench compare FILE.osa [ROUNDS]: a store on a server beside one in a file (server_compare.h).
// slamdb_server_bench search [SIZES]: where, when and "who knows this picture" among 10,100,1000 small atlases.
// slamdb_server_bench load [ATLASES SECONDS KILLS]: 8 writers and 8 readers over ATLASES (1000) for SECONDS (60) while
// the server is killed KILLS (10) times; what they saved and loaded a second, and whether an update was lost. With
// fsync and autovacuum, as servers run. slamdb_server_bench cost FILE.osa [ROUNDS]: what saves and loads of an atlas
// cost a server in time of its processor and in write-ahead log, what the atlas takes on disk, by table, and how many
// locks a save has. The server is one of its own, with its files in a temporary folder, not synced but for `load`, as
// the file is not.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iomanip>
#include <iostream>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "bench/server_compare.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/model/digest.h"
#include "slamdb/model/picture_features.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/postgresql_server.h"

namespace slamdb {
namespace {

using Clock = std::chrono::steady_clock;
using Work = std::function<void()>;

double SecondsOf(const Work& work) {
  const Clock::time_point start = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

// ---- search

Atlas SmallRoom(std::uint64_t seed) {
  Atlas room =
      SynthesizeAtlas({.sensor = Sensor::kStereo, .keyframes = 8, .points = 300, .features = 200, .seed = seed});
  for (Map& map : room.maps) {
    for (KeyFrame& keyframe : map.keyframes) keyframe.timestamp += 1000 * static_cast<double>(seed);
    for (MapPoint& point : map.points) point.position.x() += 100 * static_cast<float>(seed);
  }
  return room;
}

int Search(const std::vector<std::size_t>& sizes) {
  PostgresqlServer server("shared_buffers = 256MB\nmax_wal_size = 4GB");
  const std::string uri = server.Uri(server.MakeDatabase());
  Store store = Store::OpenForWriting(uri, {.sync = false});
  std::cout << "| atlases | where | when | who knows a picture | list |\n|---|---|---|---|---|\n"
            << std::setprecision(3);
  std::size_t made = 0;
  for (const std::size_t size : sizes) {
    for (; made < size; ++made) store.Save("room" + std::to_string(made), SmallRoom(made));
    const Atlas asked = SmallRoom(size / 2);
    MapQuery where, when;
    where.near = MapQuery::Ball{asked.maps[0].points[0].position.cast<double>(), 0.1};
    const double time = asked.maps[0].keyframes[0].timestamp;
    when.times = MapQuery::Times{time, time + 0.1};
    const auto& descriptors = asked.maps[0].keyframes[4].features.descriptors;
    const std::vector<Descriptor> picture(descriptors.begin(), descriptors.end());
    const std::span<const Descriptor> pictures[] = {picture};
    const auto median = [&](const Work& work) {
      std::vector<double> times;
      for (int i = 0; i < 9; ++i) times.push_back(1e3 * SecondsOf(work));
      return Quantile(times, 0.5);
    };
    std::size_t found = 0;
    std::cout << "| " << size << " | " << median([&] { found += store.Find(where).size(); }) << " ms | "
              << median([&] { found += store.Find(when).size(); }) << " ms | "
              << median([&] { found += store.PlacesLike(pictures).by_picture[0].size(); }) << " ms | "
              << median([&] { found += store.List().size(); }) << " ms |" << (found == 0 ? " nothing" : "") << "\n"
              << std::flush;
  }
  return 0;
}

// ---- cost

// What a server spends on one client's work.
class Meter {
 public:
  explicit Meter(const std::string& uri) : connection_(uri) {}

  struct Spent {
    double seconds = 0, processor = 0,
           log_bytes = 0;  // processor: seconds of the server process that serves the client
  };
  Spent Of(const Work& work) {
    const double processor = Processor(), log = Log();
    Spent spent{.seconds = SecondsOf(work)};
    spent.processor = Processor() - processor;
    spent.log_bytes = Log() - log;
    return spent;
  }
  std::int64_t Locks() { return connection_.Integer("SELECT count(*) FROM pg_locks WHERE pid <> pg_backend_pid()"); }
  void Checkpoint() { connection_.Execute("CHECKPOINT"); }
  postgresql::Result Query(const std::string& sql) { return connection_.Query(sql); }

 private:
  double Log() {
    return static_cast<double>(connection_.Integer("SELECT (pg_current_wal_insert_lsn() - '0/0')::bigint"));
  }
  // On a processor until now, by the kernel's count of nanoseconds.
  double Processor() {
    const std::int64_t process = connection_.Integer(
        "SELECT pid FROM pg_stat_activity WHERE application_name LIKE 'slamdb%' AND pid <> pg_backend_pid()");
    double nanoseconds = 0;
    std::ifstream("/proc/" + std::to_string(process) + "/schedstat") >> nanoseconds;
    return 1e-9 * nanoseconds;
  }

  postgresql::Connection connection_;
};

int CostOfAnAtlas(const std::string& path, int rounds) {
  const Atlas atlas = ReadAtlas(path);
  PostgresqlServer server("shared_buffers = 256MB\nmax_wal_size = 4GB");
  const std::string uri = server.Uri(server.MakeDatabase());
  Store store = Store::OpenForWriting(uri);
  Meter meter(uri);
  std::cout << "| | time | of that the server's processor | write-ahead log |\n|---|---|---|---|\n"
            << std::setprecision(3);
  const auto row = [&](const char* what, const std::function<Meter::Spent(int)>& measure) {
    std::vector<double> seconds, processor, log;
    for (int round = 0; round < rounds; ++round) {
      const Meter::Spent spent = measure(round);
      seconds.push_back(1e3 * spent.seconds);
      processor.push_back(1e3 * spent.processor);
      log.push_back(1e-6 * spent.log_bytes);
    }
    std::cout << "| " << what << " | " << Quantile(seconds, 0.5) << " ms | " << Quantile(processor, 0.5) << " ms | "
              << Quantile(log, 0.5) << " MB |\n"
              << std::flush;
  };
  const auto name = [](int round) { return detail::Concat("a", round); };
  row("save", [&](int round) { return meter.Of([&] { store.Save(name(round), atlas); }); });
  int version = 0;
  const auto change = [&](int) {
    const Atlas next = bench::Changed(atlas, ++version);
    return meter.Of([&] { store.Save("a0", next); });
  };
  row("save after 1 %", change);
  row("the first after a checkpoint", [&](int round) {
    meter.Checkpoint();
    return change(round);
  });
  row("save of what is there", [&](int) { return meter.Of([&] { store.Save("a1", atlas); }); });
  row("load", [&](int) { return meter.Of([&] { store.Load("a1"); }); });

  std::int64_t locks = 0;
  SaveOptions options;
  options.before_commit = [&] { locks = meter.Locks(); };
  store.Save("one more", atlas, options);
  std::size_t keyframes = 0, points = 0;
  for (const Map& map : atlas.maps) {
    keyframes += map.keyframes.size();
    points += map.points.size();
  }
  std::cout << "\n"
            << keyframes << " keyframes, " << points << " points, "
            << 1e-6 * static_cast<double>(std::filesystem::file_size(path)) << " MB as .osa; a save has " << locks
            << " locks\n";
  // Of a database with that atlas alone.
  const std::string alone = server.Uri(server.MakeDatabase());
  Store::OpenForWriting(alone).Save("a", atlas);
  Meter sizes(alone);
  const postgresql::Result tables = sizes.Query(
      "SELECT relname::text, pg_total_relation_size(oid), pg_indexes_size(oid) FROM pg_class WHERE relnamespace = "
      "'slamdb'::regnamespace AND relkind = 'r' ORDER BY 2 DESC");
  std::cout << "\n| table | MB | of that indexes | bytes a keyframe |\n|---|---|---|---|\n";
  double sum = 0;
  for (std::size_t i = 0; i < tables.rows(); ++i) {
    const auto bytes = static_cast<double>(tables[i].Integer(1));
    sum += bytes;
    std::cout << "| " << tables[i].Text(0) << " | " << 1e-6 * bytes << " | "
              << 1e-6 * static_cast<double>(tables[i].Integer(2)) << " | " << bytes / static_cast<double>(keyframes)
              << " |\n";
  }
  std::cout << "| all | " << 1e-6 * sum << " | | " << sum / static_cast<double>(keyframes) << " |\n";
  return 0;
}

// ---- load

// What one client did.
struct Log {
  std::vector<double> saves, loads;  // seconds each, of those that succeeded
  double longest_save = 0;           // with all that had failed before
  std::uint64_t failed = 0, retried = 0;
};

class Fleet {
 public:
  Fleet(std::size_t atlases, double seconds, int kills)
      : atlases_(atlases),
        seconds_(seconds),
        kills_(kills),
        server_("fsync = on\nautovacuum = on\nshared_buffers = 256MB\nmax_connections = 64"),
        uri_(server_.Uri(server_.MakeDatabase())),
        saved_(atlases, 0),
        expected_(atlases) {
    for (std::size_t i = 0; i < 16; ++i) rooms_.push_back(SmallRoom(i));
  }

  int Run() {
    Fill();
    const double log_before = LogBytes();
    std::vector<Log> logs(2 * kClients);
    std::vector<std::thread> clients;
    const Clock::time_point end =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds_));
    for (std::size_t i = 0; i < kClients; ++i) clients.emplace_back([&, i] { Write(i, end, logs[i]); });
    for (std::size_t i = 0; i < kClients; ++i) clients.emplace_back([&, i] { ReadAll(i, end, logs[kClients + i]); });
    for (int kill = 0; kill < kills_; ++kill) {
      std::this_thread::sleep_for(std::chrono::duration<double>(seconds_ / (kills_ + 1)));
      server_.Kill();
      server_.Start();
    }
    for (std::thread& client : clients) client.join();
    const double log_bytes = LogBytes() - log_before;
    Tell(logs, log_bytes);
    return CountLost() == 0 ? 0 : 1;
  }

 private:
  static constexpr std::size_t kClients = 8;

  double LogBytes() const {
    return static_cast<double>(
        postgresql::Connection(uri_).Integer("SELECT (pg_current_wal_insert_lsn() - '0/0')::bigint"));
  }
  Atlas Version(std::size_t atlas, std::uint64_t version) const {
    Atlas made = rooms_[atlas % rooms_.size()];
    made.maps[0].points[0].position = {static_cast<float>(atlas), static_cast<float>(version), 0};
    made.maps[0].points[version % 200].normal.x() = 0.5F;
    return made;
  }
  static std::string NameOf(std::size_t atlas) { return "robot" + std::to_string(atlas); }

  void Fill() {
    Store store = Store::OpenForWriting(uri_, {.sync = false});
    for (std::size_t i = 0; i < atlases_; ++i) expected_[i] = store.Save(NameOf(i), Version(i, 0)).hash;
    megabytes_ = static_cast<double>(store.List()[0].bytes) / 1e6;
  }

  // Each writer has atlases of its own, so that what must be there at the end is known.
  void Write(std::size_t client, Clock::time_point end, Log& log) {
    std::mt19937_64 random(client);
    while (Clock::now() < end) {
      const std::size_t atlas = random() % (atlases_ / kClients) * kClients + client;
      const Atlas next = Version(atlas, saved_[atlas] + 1);
      const Clock::time_point start = Clock::now();
      for (bool done = false; !done;) {
        try {
          SaveReport report;
          log.saves.push_back(SecondsOf([&] { report = Store::OpenForWriting(uri_).Save(NameOf(atlas), next); }));
          expected_[atlas] = report.hash;
          ++saved_[atlas];
          done = true;
          log.longest_save = std::max(log.longest_save, std::chrono::duration<double>(Clock::now() - start).count());
        } catch (const Error&) {  // the server was killed: try again
          ++log.retried;
          std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
      }
    }
  }
  void ReadAll(std::size_t client, Clock::time_point end, Log& log) {
    std::mt19937_64 random(100 + client);
    while (Clock::now() < end) {
      const std::string name = NameOf(random() % atlases_);
      try {
        log.loads.push_back(SecondsOf([&] { Store::Open(uri_).Load(name); }));
      } catch (const Error& error) {
        if (error.kind() == ErrorKind::kDamaged) {
          ++log.failed;
          std::cerr << error.what() << "\n";
        }
        ++log.retried;
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      }
    }
  }

  std::size_t CountLost() {
    Store store = Store::Open(uri_);
    std::size_t lost = 0;
    for (std::size_t i = 0; i < atlases_; ++i)
      lost += HashOf(store.Load(NameOf(i))) != expected_[i] || store.FindRevision(NameOf(i)).number != saved_[i] + 1;
    std::cout << "lost updates: " << lost << " of " << atlases_ << " atlases\n";
    return lost;
  }

  void Tell(const std::vector<Log>& logs, double log_bytes) const {
    Log sum;
    for (const Log& log : logs) {
      sum.saves.insert(sum.saves.end(), log.saves.begin(), log.saves.end());
      sum.loads.insert(sum.loads.end(), log.loads.begin(), log.loads.end());
      sum.longest_save = std::max(sum.longest_save, log.longest_save);
      sum.failed += log.failed;
      sum.retried += log.retried;
    }
    const auto row = [&](const char* what, const std::vector<double>& times) {
      const double rate = static_cast<double>(times.size()) / seconds_;
      std::cout << "| " << what << " | " << rate << " a second, " << rate * megabytes_ << " MB/s | "
                << 1e3 * Quantile(times, 0.5) << " ms | " << 1e3 * Quantile(times, 0.95) << " ms | "
                << 1e3 * Quantile(times, 0.99) << " ms | " << 1e3 * Quantile(times, 1) << " ms |\n";
    };
    std::cout << "| " << kClients << " writers, " << kClients << " readers, " << atlases_ << " atlases, " << kills_
              << " kills | | half | 95 % | 99 % | all |\n|---|---|---|---|---|---|\n";
    row("saves", sum.saves);
    row("loads", sum.loads);
    std::cout << sum.saves.size() << " saves, " << sum.loads.size() << " loads; tried again: " << sum.retried
              << ", damaged: " << sum.failed << "; the longest save with what had failed before: " << sum.longest_save
              << " s; write-ahead log: " << 1e-3 * log_bytes / static_cast<double>(sum.saves.size())
              << " kB a save; an atlas: " << megabytes_ << " MB\n";
  }

  std::size_t atlases_;
  double seconds_;
  int kills_;
  PostgresqlServer server_;
  std::string uri_;
  std::vector<Atlas> rooms_;
  double megabytes_ = 0;                         // of an atlas
  std::vector<std::uint64_t> saved_, expected_;  // by atlas: versions, hashes
};

}  // namespace
}  // namespace slamdb

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const auto number = [&](std::size_t i, int other) { return i < words.size() ? std::stoi(words[i]) : other; };
  if (words.size() >= 2 && words[0] == "compare") return slamdb::bench::CompareStores(words[1], number(2, 9));
  if (words.size() >= 2 && words[0] == "cost") return slamdb::CostOfAnAtlas(words[1], number(2, 9));
  if (words.size() == 1 && words[0] == "search") return slamdb::Search({10, 100, 1000});
  if (words.size() >= 2 && words[0] == "search") {
    std::vector<std::size_t> sizes;
    for (std::size_t i = 1; i < words.size(); ++i) sizes.push_back(static_cast<std::size_t>(number(i, 0)));
    return slamdb::Search(sizes);
  }
  if (!words.empty() && words[0] == "load")
    return slamdb::Fleet(static_cast<std::size_t>(number(1, 1000)), number(2, 60), number(3, 10)).Run();
  std::cerr << "slamdb_server_bench compare FILE.osa [ROUNDS] | search [SIZE...] | load [ATLASES SECONDS KILLS] | cost "
               "FILE.osa [ROUNDS]\n";
  return 2;
}
