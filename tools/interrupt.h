// Ctrl-C as a question asked between chunks, so that files are closed and a sweep can be resumed.
#pragma once

namespace gliss {

inline constexpr int kExitInterrupted = 130;

// From now on SIGINT and SIGTERM set a flag; the next one exits at once with kExitInterrupted.
void catch_interrupts();
bool interrupted() noexcept;

}  // namespace gliss
