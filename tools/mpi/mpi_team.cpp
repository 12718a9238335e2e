#include "tools/mpi/mpi_team.h"

#include <fmt/format.h>
#ifdef GLISS_PARALLEL_HDF5
#include <hdf5.h>
#endif
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <thread>

#include "gliss/base/stopwatch.h"
#include "tools/cli/terminal/watch.h"

namespace gliss::tools {
namespace {

// Seconds in which all ranks that fail for one reason have done so.
constexpr double kTogether = 1;

// Waits without keeping a core busy, which others may need. False where is_over() says so first.
template <class IsOver>
bool wait_until(MPI_Request& request, const IsOver& is_over) {
  for (int done = 0;;) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done != 0) return true;
    if (is_over()) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void wait(MPI_Request& request) {
  wait_until(request, [] {
    stop_if_interrupted();
    return false;
  });
}

}  // namespace

MpiTeam::MpiTeam() {
  int rank = 0, size = 1;
  MPI_Comm_dup(MPI_COMM_WORLD, &members_);
  MPI_Comm_dup(MPI_COMM_WORLD, &ending_);
  MPI_Comm_rank(members_, &rank);
  MPI_Comm_size(members_, &size);
  rank_ = static_cast<std::size_t>(rank);
  size_ = static_cast<std::size_t>(size);
  std::uint64_t* next = nullptr;
  MPI_Win_allocate(rank == 0 ? sizeof *next : 0, sizeof *next, MPI_INFO_NULL, members_, &next,
                   &counter_);
  MPI_Win_lock_all(0, counter_);
  if (rank == 0) {
    *next = 0;
    MPI_Win_sync(counter_);
  }
  MPI_Barrier(members_);
  char host[MPI_MAX_PROCESSOR_NAME];
  int length = 0;
  MPI_Get_processor_name(host, &length);
  hosts_ = gather({host, static_cast<std::size_t>(length)});
  find_threads();
}

MpiTeam::~MpiTeam() {
  MPI_Win_unlock_all(counter_);
  MPI_Win_free(&counter_);
}

// The cores that this rank is bound to; ranks that are bound to the same ones share them.
void MpiTeam::find_threads() {
  cpu_set_t own{};
  sched_getaffinity(0, sizeof own, &own);
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(members_, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  int rank = 0, size = 1;
  MPI_Comm_rank(machine, &rank);
  MPI_Comm_size(machine, &size);
  std::vector<cpu_set_t> all(static_cast<std::size_t>(size));
  MPI_Allgather(&own, sizeof own, MPI_BYTE, all.data(), sizeof own, MPI_BYTE, machine);
  MPI_Comm_free(&machine);
  const auto same = [&](const cpu_set_t& other) { return CPU_EQUAL(&own, &other) != 0; };
  const auto sharers = static_cast<int>(std::count_if(all.begin(), all.end(), same)),
             before = static_cast<int>(std::count_if(all.begin(), all.begin() + rank, same)),
             cores = CPU_COUNT(&own);
  threads_ = std::max(1, cores / sharers + (before < cores % sharers ? 1 : 0));
}

std::size_t MpiTeam::next_part() const {
  const std::uint64_t one = 1;
  std::uint64_t next = 0;
  MPI_Fetch_and_op(&one, &next, MPI_UINT64_T, 0, 0, MPI_SUM, counter_);
  MPI_Win_flush(0, counter_);
  return next;
}

MpiTeam::Text MpiTeam::text_of(const std::string& words) {
  Text text{};
  words.copy(text.data(), text.size() - 1);
  return text;
}

std::vector<std::string> MpiTeam::gather(const std::string& text) const {
  own_ = text_of(text);
  all_.resize(size_);
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallgather(own_.data(), sizeof(Text), MPI_CHAR, all_.data(), sizeof(Text), MPI_CHAR, members_,
                 &request);
  wait(request);
  std::vector<std::string> texts;
  for (const Text& of_rank : all_) texts.emplace_back(of_rank.data());
  return texts;
}

void MpiTeam::sum(std::vector<std::uint64_t>& values) const {
  sums_ = values;
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallreduce(MPI_IN_PLACE, sums_.data(), static_cast<int>(sums_.size()), MPI_UINT64_T, MPI_SUM,
                 members_, &request);
  wait(request);
  values = sums_;
}

std::string MpiTeam::name_of(std::size_t rank) const {
  return fmt::format("rank {} on {}", rank, hosts_[rank]);
}

// Whatever MPI is asked, it does what others wait for.
void MpiTeam::answer() const {
  int there = 0;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, members_, &there, MPI_STATUS_IGNORE);
}

Hdf5Access MpiTeam::hdf5_access() const {
#ifdef GLISS_PARALLEL_HDF5
  return [this](std::int64_t list) {
    if (H5Pset_fapl_mpio(list, members_, MPI_INFO_NULL) < 0)
      throw std::runtime_error("HDF5 cannot open files by MPI");
  };
#else
  return nullptr;
#endif
}

int MpiTeam::end(const End& end) const {
  struct Ended {
    int code;
    Text message;
  };
  const Ended own{end.code, text_of(end.message)};
  std::vector<Ended> all(size_);
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallgather(&own, sizeof own, MPI_BYTE, all.data(), sizeof own, MPI_BYTE, ending_, &request);
  const Stopwatch waited;
  const auto is_alone = [&] { return end.code != 0 && waited.seconds() > kTogether; };
  const bool together = wait_until(request, is_alone);
  const bool is_common = together && std::all_of(all.begin(), all.end(), [&](const Ended& other) {
                           return other.message == own.message;
                         });
  if (!is_common)
    tell("gliss-mpi: " + name_of(rank_), end);
  else if (rank_ == 0)
    tell("gliss-mpi", end);
  if (!together) MPI_Abort(MPI_COMM_WORLD, end.code);
  if (end.code != 0) return end.code;
  const auto failed = std::find_if(all.begin(), all.end(), [](auto& a) { return a.code != 0; });
  return failed == all.end() ? 0 : failed->code;
}

}  // namespace gliss::tools
