// An array in a device's memory, known to it by name and size.
#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "backend/device.h"
#include "base/error.h"

namespace fissure {

template <class T>
class Buffer {
 public:
  Buffer() = default;
  Buffer(Device& device, std::string name, std::size_t size) : device_(&device), name_(std::move(name)), size_(size) {
    data_ = static_cast<T*>(device.allocate(name_, size * sizeof(T)));
  }
  Buffer(Device& device, std::string name, std::vector<T> const& values) : Buffer(device, std::move(name), values.size()) {
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
      throw Error("array \"" + name_ + "\" holds " + std::to_string(size_) + " values, not " + std::to_string(values.size()));
    if (size_) device_->upload(data_, values.data(), size_ * sizeof(T));
  }
  std::vector<T> download() const {
    std::vector<T> values(size_);
    if (size_) device_->download(values.data(), data_, size_ * sizeof(T));
    return values;
  }
  /// The values where the host can read them, without a copy when it can read the device's memory.
  std::span<T const> look(std::vector<T>& copy) const {
    if (size_ == 0 || device_->backend() == Backend::cpu) return {data_, size_};
    copy = download();
    return copy;
  }
  T download_one(std::size_t i) const {
    T value;
    device_->download(&value, data_ + i, sizeof(T));
    return value;
  }
  void upload_one(std::size_t i, T const& value) { device_->upload(data_ + i, &value, sizeof(T)); }

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

}  // namespace fissure
