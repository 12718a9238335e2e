// gliss-mpi as users run it: the bytes of gliss by any number of ranks, whatever dies on the way.
#include <gmock/gmock.h>
#include <sys/file.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/support/part_files.h"
#include "tests/support/require.h"
#include "tests/support/run_files.h"

namespace gliss {
namespace {

namespace fs = std::filesystem;
using test::Outcome, test::Process;
using ::testing::AllOf;
using ::testing::HasSubstr;

using Words = std::vector<std::string>;

Words words_of(const std::string& text) { return test::split(text, ' '); }

Words joined(Words first, const Words& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

// The ranks that mpirun has started.
std::vector<pid_t> ranks_of(pid_t mpirun) {
  std::vector<pid_t> found;
  std::ifstream children(fmt::format("/proc/{0}/task/{0}/children", mpirun));
  for (pid_t child = 0; children >> child;) {
    std::string name;
    std::getline(std::ifstream(fmt::format("/proc/{}/comm", child)) >> std::ws, name);
    if (name == "gliss-mpi") found.push_back(child);
  }
  return found;
}

class Mpi : public test::RunTest {
 protected:
  void SetUp() override {
    if (*test::kMpiProgram == 0) GLISS_SKIP_UNLESS_REQUIRED("this build has no gliss-mpi");
    for (const char* name : {"OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"})
      setenv(name, "1", 1);
    if (Process(folder_ / "", "mpirun", {"--version"}).wait().code == test::kNotStarted)
      GLISS_SKIP_UNLESS_REQUIRED("mpirun is absent");
    // An mpirun that is killed leaves files, which go with the test.
    for (const char* name :
         {"TMPDIR", "OMPI_MCA_btl_vader_backing_directory", "OMPI_MCA_osc_sm_backing_directory"})
      setenv(name, folder_.path().c_str(), 1);
    setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 1);
    setenv("OMPI_MCA_btl_vader_single_copy_mechanism", "none", 1);
    EXPECT_EQ(gliss("bake ball.obj --unit mm -o ball.gliss").code, 0);
  }

  std::unique_ptr<Process> start(int ranks, const std::string& words) const {
    return std::make_unique<Process>(
        folder_ / "", "mpirun",
        joined({"-n", std::to_string(ranks), test::kMpiProgram}, words_of(words)));
  }
  Outcome run(int ranks, const std::string& words) const { return start(ranks, words)->wait(); }
  // Two ranks of their own programs and words, in this order.
  Outcome run_both(const Words& first, const Words& second) const {
    return Process(folder_ / "", "mpirun",
                   joined(joined(joined({"-n", "1"}, first), {":", "-n", "1"}), second))
        .wait();
  }
  Words mpi(const std::string& words) const { return joined({test::kMpiProgram}, words_of(words)); }

  std::size_t parts() const { return test::part_paths(folder_ / parts_folder_).size(); }
  std::string first_part() const { return test::part_paths(folder_ / parts_folder_).at(0); }
  // True once no rank works in the folder for parts.
  bool is_left() const {
    const int folder = open((folder_ / parts_folder_).c_str(), O_RDONLY);
    const bool left = folder < 0 || flock(folder, LOCK_EX | LOCK_NB) == 0;
    if (folder >= 0) close(folder);
    return left;
  }
  nlohmann::json statistics() const {
    return nlohmann::json::parse(folder_.read("s.json"))["statistics"];
  }
  // The job failed, and nobody wrote a part or a result.
  void expect_refused(const Outcome& outcome, int code, const std::string& what) const {
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("gliss-mpi: " + what));
    EXPECT_FALSE(fs::exists(folder_ / "s.json"));
    EXPECT_EQ(parts(), 0u);
  }

  // One of the ranks or mpirun itself, by kill -9, at some moment; each time other ranks go on.
  // A result that is there then is the whole one.
  void expect_survives_kills(const std::string& words, const std::string& file, int rounds,
                             const std::function<std::string()>& result) {
    ASSERT_EQ(gliss(words).code, 0);
    const std::string want = result();
    fs::remove(folder_ / file);
    std::mt19937_64 rng(4);
    if (std::getenv("GLISS_LONG_TESTS") != nullptr) rounds = 20;
    int kills = 0;
    for (int round = 0; round < rounds; ++round) {
      const auto job = start(1 + static_cast<int>(rng() % 4), words);
      ASSERT_TRUE(test::await([&] { return job->over() || !ranks_of(job->id()).empty(); }));
      std::this_thread::sleep_for(std::chrono::milliseconds(rng() % 900));
      const auto ranks = ranks_of(job->id());
      if (round % 2 == 0 || ranks.empty())
        job->kill(SIGKILL);
      else
        kill(ranks[rng() % ranks.size()], SIGKILL);
      kills += job->wait().code != 0;
      EXPECT_TRUE(test::await([&] { return is_left(); }));
      if (!fs::exists(folder_ / file)) continue;
      EXPECT_TRUE(result() == want);
      fs::remove(folder_ / file);
    }
    EXPECT_GT(kills, 0);
    EXPECT_EQ(run(2, words).code, 0);
    EXPECT_FALSE(fs::exists(folder_ / parts_folder_));
    EXPECT_TRUE(result() == want);
    fmt::print("  gliss-mpi: killed {} times\n", kills);
  }

  std::string parts_folder_ = "s.json.parts";
  // Four parts without samples, and eight.
  const std::string sweep_ =
      "sweep ball.gliss --depth 1mm --method flat --samples 1.7e6 --summary s.json --quiet";
  const std::string long_sweep_ =
      "sweep ball.gliss --depth 1mm,2mm --method flat --samples 1.7e6 --summary s.json --quiet";
};

TEST_F(Mpi, is_no_part_of_gliss) {
  const auto needs = [&](const char* program, const char* library) {
    return Process(folder_ / "", "readelf", {"-d", program}).wait().out.find(library) !=
           std::string::npos;
  };
  EXPECT_FALSE(needs(test::kProgram, "mpi"));
  EXPECT_TRUE(needs(test::kMpiProgram, "libmpi"));
  // One HDF5 each.
  EXPECT_TRUE(needs(test::kProgram, "libhdf5"));
  EXPECT_NE(needs(test::kMpiProgram, "libhdf5_openmpi"),
            needs(test::kMpiProgram, "libhdf5_serial"));
}

TEST_F(Mpi, gives_the_bytes_of_gliss_by_three_ranks) {
  const std::string words =
      "sweep ball.gliss --depth 1mm --method flat --samples 1.1e6 -o s.h5 --quiet";
  ASSERT_EQ(gliss(words).code, 0);
  const std::string want = folder_.read("s.h5");
  fs::remove(folder_ / "s.h5");
  const Outcome outcome = run(3, words);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(folder_.read("s.h5") == want);
  EXPECT_FALSE(fs::exists(folder_ / "s.h5.parts"));
}

// Written by all ranks at once, by rank 0 alone where there is a picture as well, from shards, and
// by gliss.
TEST_F(Mpi, gives_one_plain_file_by_any_number_of_ranks) {
  const std::string words =
      "sweep ball.gliss --depth 1mm --method flat --samples 5.4e5 --layout plain -o s.h5 --quiet";
  ASSERT_EQ(gliss(words).code, 0);
  const std::string want = folder_.read("s.h5");
  for (const int ranks : {1, 2, 4}) {
    fs::remove(folder_ / "s.h5");
    if (ranks == 2) {
      EXPECT_EQ(gliss(words + " --shard 2/2").code, 0);
    }
    const Outcome outcome = run(ranks, words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(folder_.read("s.h5") == want) << ranks;
    EXPECT_FALSE(fs::exists(folder_ / "s.h5.parts"));
    EXPECT_EQ(outcome.err, "");
  }
  const std::string with_picture =
      "sweep ball.gliss --depth 1mm --rings 3 --layout plain -o s.h5 --vtp s.vtp --quiet";
  ASSERT_EQ(gliss(with_picture).code, 0);
  const std::string want_with_picture = folder_.read("s.h5");
  fs::remove(folder_ / "s.h5");
  EXPECT_EQ(run(2, with_picture).code, 0);
  EXPECT_TRUE(folder_.read("s.h5") == want_with_picture);
}

// Sums are rounded part by part: they are the same to the last bit where parts are put together in
// their order.
TEST_F(Mpi, gives_the_statistics_of_gliss_by_any_number_of_ranks) {
  ASSERT_EQ(gliss(sweep_).code, 0);
  const auto want = statistics();
  for (const int ranks : {1, 2, 4}) {
    fs::remove(folder_ / "s.json");
    const Outcome outcome = run(ranks, sweep_ + " --json --threads 1");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(statistics() == want) << ranks;
    const auto json = nlohmann::json::parse(outcome.out);  // of one rank alone
    EXPECT_EQ(json["contacts_computed"], json["samples_per_depth"]);
    EXPECT_EQ(json["mpi"]["ranks"], ranks);
    EXPECT_EQ(json["mpi"]["parts"], 4);
    EXPECT_FALSE(fs::exists(folder_ / "s.json.parts"));
  }
}

TEST_F(Mpi, survives_kills) {
  expect_survives_kills(long_sweep_, "s.json", 4, [&] { return statistics().dump(); });
}

TEST_F(Mpi, leaves_parts_when_it_is_interrupted_and_shards_and_gliss_go_on_from_them) {
  const std::string words =  // parts enough for an interruption to come in time
      "sweep ball.gliss --depth 1mm --method gregory --samples 4e6 --summary s.json --quiet";
  ASSERT_EQ(gliss(words).code, 0);
  const auto want = statistics();
  fs::remove(folder_ / "s.json");
  // Open MPI kills a second later, before which a busy machine may say nothing.
  bool told = false;
  for (int tries = 0; tries < 4 && !told; ++tries) {
    fs::remove_all(folder_ / "s.json.parts");  // else the last try has little left to do
    const auto job = start(2, words);
    ASSERT_TRUE(test::await([&] { return parts() > 0 || job->over(); }));
    job->kill(SIGINT);
    const Outcome outcome = job->wait();
    ASSERT_NE(outcome.code, 0);
    told = outcome.err.find("interrupted; parts are in 's.json.parts': the same command goes on") !=
           std::string::npos;
    EXPECT_FALSE(fs::exists(folder_ / "s.json"));
    EXPECT_TRUE(test::await([&] { return is_left(); }));
  }
  EXPECT_TRUE(told);
  EXPECT_EQ(gliss(words + " --shard 2/2").code, 0);
  std::ofstream(first_part(), std::ios::app) << "damage";
  const Outcome last = run(3, words);
  EXPECT_EQ(last.code, 0) << last.err;
  EXPECT_THAT(last.err, HasSubstr("was damaged, its part is computed again"));
  EXPECT_TRUE(statistics() == want);
}

TEST_F(Mpi, refuses_ranks_that_do_not_fit_together) {
  EXPECT_EQ(gliss("bake ball.obj --unit mm --construction paper -o other.gliss").code, 0);
  expect_refused(run_both(mpi(sweep_), mpi("sweep other" + sweep_.substr(10))), 2,
                 "the surface is not the same everywhere: rank 0 on ");
  expect_refused(run_both(mpi(sweep_), mpi(sweep_ + " --stiffness 1N/mm")), 2,
                 "the sweep is not the same everywhere: rank 0 on ");
  expect_refused(run_both(mpi(sweep_ + " -o s.h5 --parts s.json.parts --layout plain"),
                          mpi(sweep_ + " -o s.h5 --parts s.json.parts")),
                 2, "who writes the result is not the same everywhere: rank 0 on ");
  expect_refused(run_both(mpi(sweep_), mpi("sweep none" + sweep_.substr(10))), 2, "rank 1 on ");

  // The same program, and says that it is another version.
  std::string program = test::read_file(test::kMpiProgram);
  const std::string version = words_of(gliss("--version").out).back().substr(0, 5);
  for (auto at = program.find(version); at != program.npos; at = program.find(version, at))
    program.replace(at, version.size(), version.size(), '9');
  const std::string other = folder_.write("other-mpi", program);
  fs::permissions(other, fs::perms::owner_all);
  expect_refused(run_both(mpi(sweep_), joined({other}, words_of(sweep_))), 2,
                 "the version of the program is not the same everywhere: rank 0 on ");
}

// Machines that have disks of their own have such folders.
TEST_F(Mpi, refuses_folders_that_are_not_shared) {
  fs::create_directory(folder_ / "here");
  fs::create_directory(folder_ / "there");
  const std::string words = "sweep ../" + sweep_.substr(6);
  const Outcome outcome = run_both(joined({"-wdir", folder_ / "here"}, mpi(words)),
                                   joined({"-wdir", folder_ / "there"}, mpi(words)));
  expect_refused(outcome, 2, "the parts folder 's.json.parts' of rank 1 on ");
  EXPECT_THAT(outcome.err, HasSubstr("is not that of rank 0 on "));
}

TEST_F(Mpi, says_which_rank_has_a_full_disk_and_goes_on_afterwards) {
  const std::string words =
      "sweep ball.gliss --depth 1mm --method flat --samples 1.1e6 -o s.h5 --quiet";
  const std::string limited =
      fmt::format("ulimit -f 40000; exec '{}' {}", test::kMpiProgram, words);
  const Outcome outcome = run_both(mpi(words), {"sh", "-c", limited});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("gliss-mpi: rank 1 on "), HasSubstr("cannot write "),
                                 HasSubstr("File too large")));
  EXPECT_FALSE(fs::exists(folder_ / "s.h5"));
}

// Parts have room, and the end of the columns of the result has none.
TEST_F(Mpi, says_which_rank_cannot_write_a_plain_file_and_goes_on_from_its_parts) {
  const std::string words =
      "sweep ball.gliss --depth 1mm --method flat --samples 8e5 --layout plain -o s.h5 --quiet";
  ASSERT_EQ(gliss(words).code, 0);
  const std::string want = folder_.read("s.h5");
  fs::remove(folder_ / "s.h5");
  const std::string limited =
      fmt::format("ulimit -f 130000; exec '{}' {}", test::kMpiProgram, words);
  for (const bool leads : {false, true}) {
    const Words weak{"sh", "-c", limited};
    const Outcome outcome = leads ? run_both(weak, mpi(words)) : run_both(mpi(words), weak);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(leads ? "rank 0 on " : "rank 1 on "),
                                   HasSubstr("cannot write 's.h5': ")));
    EXPECT_FALSE(fs::exists(folder_ / "s.h5"));
    EXPECT_TRUE(fs::exists(folder_ / "s.h5.parts"));
  }
  EXPECT_EQ(run(3, words).code, 0);
  EXPECT_TRUE(folder_.read("s.h5") == want);
}

// A rank dies while all write the file together, or seal it.
TEST_F(Mpi, survives_kills_while_it_writes_a_plain_file) {
  const std::string words =
      "sweep ball.gliss --depth 1mm --method flat --samples 5.4e5 --layout plain -o s.h5 --quiet";
  ASSERT_EQ(gliss(words).code, 0);
  const std::string want = folder_.read("s.h5");
  fs::remove(folder_ / "s.h5");
  ASSERT_EQ(gliss(words + " --shard 1/1").code, 0);  // what is left is to write
  std::mt19937_64 rng(5);
  const int rounds = std::getenv("GLISS_LONG_TESTS") != nullptr ? 30 : 3;
  for (int round = 0; round < rounds && fs::exists(folder_ / "s.h5.parts"); ++round) {
    const auto job = start(2, words);
    const auto writes = [&] {
      for (const auto& file : fs::directory_iterator(folder_.path()))
        if (file.path().string().find("s.h5.gliss-tmp") != std::string::npos) return true;
      return job->over();
    };
    ASSERT_TRUE(test::await(writes));
    std::this_thread::sleep_for(std::chrono::milliseconds(rng() % 300));
    const auto ranks = ranks_of(job->id());
    if (ranks.empty()) break;
    kill(ranks[rng() % ranks.size()], SIGKILL);
    job->wait();
    EXPECT_TRUE(!fs::exists(folder_ / "s.h5") || folder_.read("s.h5") == want);
  }
  EXPECT_EQ(run(3, words).code, 0);
  EXPECT_TRUE(folder_.read("s.h5") == want);
  EXPECT_FALSE(fs::exists(folder_ / "s.h5.parts"));
}

TEST_F(Mpi, refuses_words_that_make_no_sense_once_for_all_ranks) {
  for (const auto& [words, what] : std::vector<std::pair<std::string, std::string>>{
           {sweep_ + " --nonsense", "there is no option '--nonsense'"},
           {sweep_ + " --shard 1/2", "--shard: ranks share the parts without it"},
           {"sweep ball.gliss --depth 1mm", "parts that are shared need a folder; add"},
           {"bake ball.obj", "there is no command 'bake'; gliss-mpi --help lists them"}}) {
    const Outcome outcome = run(2, words);
    expect_refused(outcome, 2, what);
    EXPECT_EQ(outcome.err.find(what), outcome.err.rfind(what)) << outcome.err;
  }
}

class MpiProject : public Mpi {
 protected:
  static constexpr std::size_t kRows = (2 << 17) + 1000;  // two parts and a bit

  void SetUp() override {
    Mpi::SetUp();
    parts_folder_ = "p.h5.parts";
    if (!IsSkipped()) test::write_hips(folder_ / "hips.npy", kRows);
  }

  const std::string words_ =
      "project ball.gliss --unit mm --method flat --keep id --hip hips.npy -o p.h5 --threads 1";
};

TEST_F(MpiProject, gives_the_bytes_of_gliss_by_any_number_of_ranks) {
  ASSERT_EQ(gliss(words_).code, 0);
  const std::string want = folder_.read("p.h5");
  for (const int ranks : {1, 4}) {
    fs::remove(folder_ / "p.h5");
    const Outcome outcome = run(ranks, words_);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr(fmt::format("{} HIPs, ", kRows)));
    EXPECT_TRUE(folder_.read("p.h5") == want) << ranks;
    EXPECT_FALSE(fs::exists(folder_ / "p.h5.parts"));
  }
  const auto json = nlohmann::json::parse(run(2, words_ + " --json").out);  // of one rank alone
  EXPECT_EQ(json["hips"], kRows);
  EXPECT_EQ(json["contacts_computed"], kRows);
  EXPECT_EQ(json["mpi"]["ranks"], 2);
  EXPECT_EQ(json["mpi"]["parts"], 3);
}

TEST_F(MpiProject, survives_kills) {
  expect_survives_kills(words_, "p.h5", 2, [&] { return folder_.read("p.h5"); });
}

TEST_F(MpiProject, refuses_other_hips_and_options) {
  test::write_hips(folder_ / "other.npy", kRows, 1);
  const auto other = [&](const std::string& from, const std::string& to) {
    std::string words = words_;
    return words.replace(words.find(from), from.size(), to);
  };
  for (const auto& [words, what] : std::vector<std::pair<std::string, std::string>>{
           {other("hips.npy", "other.npy"),
            "the file of HIPs is not the same everywhere: rank 0 on "},
           {other("flat", "shaded"), "the work is not the same everywhere: rank 0 on "}}) {
    const Outcome outcome = run_both(mpi(words_), mpi(words));
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("gliss-mpi: " + what));
    EXPECT_FALSE(fs::exists(folder_ / "p.h5"));
  }
}

}  // namespace
}  // namespace gliss
