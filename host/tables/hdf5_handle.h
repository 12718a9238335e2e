// Two things that the C API of HDF5 lacks: identifiers that close themselves, and failures that are
// exceptions.
#pragma once

#include <hdf5.h>

#include <string>
#include <utility>

namespace gliss::hdf5 {

// While one lives, failures of HDF5 print nothing on this thread. Every public member begins with
// one.
class Quiet {
 public:
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

// Throws std::runtime_error "action: innermost reason of HDF5's error stack".
[[noreturn]] void fail(const std::string& action);

// Passes a result through; every function of HDF5 says failure by a negative one.
template <class Result>
Result check(Result result, const std::string& action) {
  if (result < 0) fail(action);
  return result;
}

class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Close close, const std::string& action)
      : id_(check(id, action)), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }

  operator hid_t() const { return id_; }
  // Leaves it open for good.
  hid_t release() { return std::exchange(id_, -1); }
  // Closing is when HDF5 writes what it held back, so an owner who cares for the data closes by
  // hand.
  void close(const std::string& action) {
    if (id_ >= 0) check(close_(std::exchange(id_, -1)), action);
  }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

}  // namespace gliss::hdf5
