// The ranks of an MPI job as the members of a team.
#pragma once

#include <mpi.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/cli/parts/team.h"
#include "tools/cli/program.h"

namespace gliss::tools {

// Between MPI_Init and MPI_Finalize. MPI is called by the thread that made it alone.
class MpiTeam : public Team {
 public:
  MpiTeam();
  ~MpiTeam() override;
  MpiTeam(const MpiTeam&) = delete;
  MpiTeam& operator=(const MpiTeam&) = delete;

  std::size_t size() const override { return size_; }
  std::size_t rank() const override { return rank_; }
  std::size_t next_part() const override;
  int threads() const override { return threads_; }
  std::vector<std::string> gather(const std::string& text) const override;
  void sum(std::vector<std::uint64_t>& values) const override;
  std::string name_of(std::size_t rank) const override;
  void answer() const override;
  Hdf5Access hdf5_access() const override;

  // Ends this rank: waits for the others, and says what went wrong, once where it is the same for
  // all. Ends the whole job where the others have more to do and this one has failed. The exit
  // code: not 0 where any rank has failed.
  int end(const End& end) const;

 private:
  // Cut to so many bytes with the zero behind it, which does for all that is compared.
  using Text = std::array<char, 256>;
  static Text text_of(const std::string& words);
  void find_threads();

  MPI_Comm members_ = MPI_COMM_NULL, ending_ = MPI_COMM_NULL;
  MPI_Win counter_ = MPI_WIN_NULL;  // of parts, in rank 0
  std::size_t rank_ = 0, size_ = 1;
  int threads_ = 1;
  std::vector<std::string> hosts_;  // [rank]
  // They stay while a request that was given up may still write to them.
  mutable Text own_{};
  mutable std::vector<Text> all_;
  mutable std::vector<std::uint64_t> sums_;
};

}  // namespace gliss::tools
