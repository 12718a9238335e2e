// Runs a fuzz target over files, and over the files of folders: what libFuzzer does with a corpus,
// for any compiler.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "tests/fuzz/fuzz.h"

namespace {

namespace fs = std::filesystem;

void add_files(const fs::path& path, std::vector<fs::path>& files) {
  if (!fs::is_directory(path)) return files.push_back(path);
  for (const auto& entry : fs::directory_iterator(path)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
}

}  // namespace

int main(int count, char** words) {
  std::vector<fs::path> files;
  for (int i = 1; i < count; ++i) add_files(words[i], files);
  std::sort(files.begin(), files.end());
  for (const fs::path& path : files) {
    std::ifstream file(path, std::ios::binary);
    // Bytes of exactly their size, so that the sanitizer sees a step beyond.
    const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
    gliss::fuzz::require(!file.bad(), path.string() + " can be read");
    std::fprintf(stderr, "%s\n", path.c_str());  // the last one is the one that fails
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  std::printf("%zu files\n", files.size());
  return files.empty() ? 1 : 0;
}
