// An array in a device's memory, known to it by name and size.
#pragma once
#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "backend/device.h"
#include "base/error.h"
#include "base/expect.h"

namespace fissure {

template <class T>
class Buffer {
 public:
  Buffer() = default;
  Buffer(Device& device, std::string name, std::size_t size) : device_(&device), name_(std::move(name)), size_(size) {
    data_ = static_cast<T*>(device.allocate(name_, size * sizeof(T)));
  }
  Buffer(Device& device, std::string name, std::vector<T> const& values)
      : Buffer(device, std::move(name), values.size()) {
    upload(values);
  }
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Buffer() {
    if (device_) device_->release(name_, size_ * sizeof(T), data_);
  }

  T* data() { return data_; }
  T const* data() const { return data_; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }

  /// As many values as the array has.
  void upload(std::vector<T> const& values) {
    if (values.size() != size_)
      throw Error("array \"" + name_ + "\" holds " + std::to_string(size_) + " values, not " +
                  std::to_string(values.size()));
    if (size_) device_->upload(data_, values.data(), size_ * sizeof(T));
  }
  std::vector<T> download() const {
    std::vector<T> values(size_);
    if (size_) device_->download(values.data(), data_, size_ * sizeof(T));
    return values;
  }
  /// The first n values.
  std::vector<T> download_first(std::size_t n) const {
    FISSURE_EXPECT(n <= size_);
    std::vector<T> values(n);
    if (n) device_->download(values.data(), data_, n * sizeof(T));
    return values;
  }
  bool host_can_read() const { return size_ == 0 || device_->backend() == Backend::cpu; }
  /// The values where the host can read them, without a copy when it can read the device's memory.
  std::span<T const> look(std::vector<T>& copy) const {
    if (host_can_read()) return {data_, size_};
    copy.resize(size_);  // fresh pages cost more than the copy: callers keep theirs
    device_->download(copy.data(), data_, size_ * sizeof(T));
    return copy;
  }
  /// The values at these places, gathered on the device: one copy.
  std::vector<T> pick(std::vector<std::size_t> const& at) const {
    std::vector<T> values(at.size());
    FISSURE_EXPECT(std::all_of(at.begin(), at.end(), [&](std::size_t i) { return i < size_; }));
    if (!at.empty()) device_->gather(values.data(), data_, at, sizeof(T));
    return values;
  }
  T download_one(std::size_t i) const {
    FISSURE_EXPECT(i < size_);
    T value;
    device_->download(&value, data_ + i, sizeof(T));
    return value;
  }
  void upload_one(std::size_t i, T const& value) {
    FISSURE_EXPECT(i < size_);
    device_->upload(data_ + i, &value, sizeof(T));
  }

 private:
  void swap(Buffer& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(name_, other.name_);
    std::swap(size_, other.size_);
    std::swap(data_, other.data_);
  }

  Device* device_ = nullptr;
  std::string name_;
  std::size_t size_ = 0;
  T* data_ = nullptr;
};

/// Values of an array for the host: in place where it can read the device's memory, else copies, of all or of those it
/// asks for.
template <class T>
class HostView {
 public:
  explicit HostView(Buffer<T> const& array) { all_ = array.look(copy_); }
  HostView(Buffer<T> const& array, std::vector<std::size_t> at) {
    if (array.host_can_read()) {
      all_ = array.look(copy_);
      return;
    }
    std::sort(at.begin(), at.end());
    at.erase(std::unique(at.begin(), at.end()), at.end());
    at_ = std::move(at);
    copy_ = array.pick(at_);
  }
  HostView(HostView const&) = delete;

  T operator[](std::size_t i) const {
    FISSURE_EXPECT(all_.empty() ? std::binary_search(at_.begin(), at_.end(), i) : i < all_.size());
    if (!all_.empty()) return all_[i];
    return copy_[static_cast<std::size_t>(std::lower_bound(at_.begin(), at_.end(), i) - at_.begin())];
  }

 private:
  std::span<T const> all_;
  std::vector<std::size_t> at_;  // places of the copies, ascending
  std::vector<T> copy_;
};

}  // namespace fissure
