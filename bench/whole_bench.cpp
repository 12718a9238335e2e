// Times what commands do from end to end: a sweep of the whole surface, and reading a cache.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "bench/benches.h"
#include "bench/meshes.h"
#include "bench/work.h"
#include "gliss/files/cache_file.h"
#include "gliss/sweep/sweep.h"

namespace gliss::bench {
namespace {

// Short ones pay for memory that is new.
constexpr std::uint32_t kShort = 2, kLong = 11;  // rings: 35,000 HIPs, 760,000

Work make_sweep(const Level& level, Precision precision, int threads, std::uint32_t rings,
                const std::vector<Method>& methods = SweepOptions().methods) {
  const PatchCache& cache = cache_of(Shape::kKnot, precision, level);
  SweepOptions options;
  options.depths = {2e-3, 4e-3};  // m
  options.rings = rings;
  options.methods = methods;
  const double contacts = static_cast<double>(sample_count(cache, options.rings) *
                                              options.depths.size() * options.methods.size());
  return {contacts, [&cache, options, threads] { sweep(cache, engine_of(threads), options); }};
}

// A cache in a file of its own while it lives.
class CacheFile {
 public:
  explicit CacheFile(const PatchCache& cache)
      : path_(std::filesystem::temp_directory_path() / ("gliss_bench_" + std::to_string(getpid()) +
                                                        "_" + std::to_string(next_++) + ".gliss")) {
    save_cache(cache, path_.string());
  }
  ~CacheFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  CacheFile(const CacheFile&) = delete;
  CacheFile& operator=(const CacheFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  static inline int next_ = 0;
  std::filesystem::path path_;
};

// Items: patches. `with`: what is done with the file's path and size.
template <class With>
Work on_cache_file(Precision precision, With with) {
  const PatchCache& cache = cache_of(Shape::kKnot, precision);
  const auto file = std::make_shared<CacheFile>(cache);
  const auto bytes = std::filesystem::file_size(file->path());
  Work work{static_cast<double>(cache.patch_count()), nullptr};
  work.counters["bytes"] = static_cast<double>(bytes) / work.items;
  work.run = [=] { with(file->path().string(), bytes); };
  return work;
}

Work make_load(Precision precision) {
  return on_cache_file(precision, [](const std::string& path, std::size_t) {
    benchmark::DoNotOptimize(load_cache(path));
  });
}

// The same bytes into memory of their own, and no more.
Work make_read(Precision precision) {
  return on_cache_file(precision, [](const std::string& path, std::size_t bytes) {
    const auto to = std::make_unique_for_overwrite<char[]>(bytes);
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                               std::fclose);
    if (file == nullptr || std::fread(to.get(), 1, bytes, file.get()) != bytes)
      throw std::runtime_error("cannot read " + path);
    benchmark::DoNotOptimize(to.get());
  });
}

}  // namespace

void register_whole() {
  for (const Precision p : {Precision::kFloat, Precision::kDouble}) {
    for (const int threads : {1, 2}) {
      std::vector<Rival> rivals;
      if (threads > 1)
        rivals.push_back({"x_one_thread", [=] { return make_sweep(kPapers, p, 1, kShort); }});
      add_work(
          work_name("sweep", kPapers, p, 4, threads), threads,
          [=] { return make_sweep(kPapers, p, threads, kShort); }, rivals);
    }
    for (const Level& level : {kPapers, Level()}) {
      add_work(work_name("sweep_long", level, p, 4, 1), 1,
               [=] { return make_sweep(level, p, 1, kLong); });
      add_work(work_name("sweep_long_gregory", level, p, 4, 1), 1,
               [=] { return make_sweep(level, p, 1, kLong, {Method::kGregory}); });
    }
    add_work(work_name("load", kPapers, p, 4, 1), 1, [=] { return make_load(p); },
             {{"x_read", [=] { return make_read(p); }}});
  }
}

}  // namespace gliss::bench
