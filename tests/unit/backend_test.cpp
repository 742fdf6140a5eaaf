// Devices, arrays in their memory, and kernels over ranges: on every device that this machine has.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>

#include "backend/buffer.h"
#include "backend_kernels.h"
#include "base/error.h"

namespace fissure {
namespace {

template <class F>
std::string error_of(F&& f) {
  try {
    f();
  } catch (Error const& error) {
    return error.what();
  }
  return "no error";
}

std::vector<Device> every_device() {
  std::vector<Device> devices;
  for (int threads : {1, 2, 8}) devices.push_back(Device::select("cpu", threads));
  if (cuda::why_not(0).empty()) devices.push_back(Device::select("cuda"));
  return devices;
}

/// Numbers of all sizes and both signs: their sum depends on the order of adding in every digit.
template <class Real = double>
std::vector<Real> wild_values(std::size_t n) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::vector<Real> values(n);
  for (auto& value : values) value = static_cast<Real>(normal(random) * std::pow(10.0, 3 * normal(random)));
  return values;
}

/// FISSURE_BACKEND for the length of a scope.
class Environment {
 public:
  explicit Environment(char const* value) {
    if (char const* const before = std::getenv("FISSURE_BACKEND")) before_ = before;
    if (value)
      setenv("FISSURE_BACKEND", value, 1);
    else
      unsetenv("FISSURE_BACKEND");
  }
  ~Environment() {
    if (before_.empty())
      unsetenv("FISSURE_BACKEND");
    else
      setenv("FISSURE_BACKEND", before_.c_str(), 1);
  }
  Environment(Environment const&) = delete;

 private:
  std::string before_;
};

TEST(Device, SaysWhichBackendsItKnows) {
  EXPECT_EQ(error_of([] { Device::select("cdua"); }), "unknown backend \"cdua\" (known: auto, cpu, cuda)");
  EXPECT_EQ(error_of([] { Device::select("cud"); }),
            "unknown backend \"cud\" (known: auto, cpu, cuda); did you mean \"cuda\"?");
  EXPECT_EQ(error_of([] { Device::select(""); }), "unknown backend \"\" (known: auto, cpu, cuda)");
}

TEST(Device, SaysWhyThereIsNoCuda) {
  std::string const why = cuda::why_not(0);
#if !defined(FISSURE_CUDA)
  EXPECT_EQ(why, "this program was built without CUDA");
#endif
  if (why.empty()) GTEST_SKIP() << "this machine has a usable CUDA device: " << cuda::device_name();
  EXPECT_EQ(error_of([] { Device::select("cuda"); }),
            "backend \"cuda\" cannot be used (" + why + "); run with --backend cpu?");
}

#if defined(FISSURE_CUDA)
TEST(Device, SaysThatThereIsNoDriver) {
  if (std::system("ldconfig -p 2>/dev/null | grep -q libcuda.so") == 0 || cuda::why_not(0).empty())
    GTEST_SKIP() << "this machine has a driver";
  EXPECT_EQ(cuda::why_not(0), "there is no NVIDIA driver: libcuda is not installed");
}
#endif

TEST(Device, ThatIsAutomaticIsTheBestThereIs) {
  Environment const none(nullptr);
  EXPECT_EQ(Device::select("auto").backend(), cuda::why_not(0).empty() ? Backend::cuda : Backend::cpu);
}

TEST(Device, ThatIsAutomaticHeedsTheEnvironment) {
  {
    Environment const cpu("cpu");
    EXPECT_EQ(Device::select("auto").backend(), Backend::cpu);
  }
  Environment const typo("cpuu");
  EXPECT_EQ(error_of([] { Device::select("auto"); }),
            "FISSURE_BACKEND: unknown backend \"cpuu\" (known: auto, cpu, cuda); did you mean \"cpu\"?");
  EXPECT_EQ(Device::select("cpu").backend(), Backend::cpu);  // what is asked for by name stands
}

TEST(Device, DescribesItself) {
  EXPECT_EQ(Device::select("cpu", 1).describe(), "CPU, 1 thread");
  EXPECT_EQ(Device::select("cpu", 3).describe(), "CPU, 3 threads");
}

TEST(Device, CountsWhatItHoldsByName) {
  for (auto& device : every_device()) {
    EXPECT_EQ(device.bytes(), 0u);
    {
      Buffer<double> const a(device, "a", 100), b(device, "b", 10), more(device, "a", 1), none(device, "nothing", 0);
      EXPECT_EQ(device.arrays(), (std::map<std::string, std::size_t>{{"a", 808}, {"b", 80}}));
      EXPECT_EQ(device.bytes(), 888u);
    }
    EXPECT_TRUE(device.arrays().empty());
  }
}

TEST(Device, SaysForWhatThereIsNoMemory) {
  for (auto& device : every_device())
    EXPECT_EQ(error_of([&] { Buffer<double>(device, "displacements", std::size_t{1} << 50); }),
              "no memory for displacements (8589934592 MiB); use a coarser mesh?");
}

TEST(Device, CountsLaunchesAndLaunchesNothingOverNothing) {
  for (auto& device : every_device()) {
    Buffer<Index> numbers(device, "numbers", 64);
    for_each(device, 0, 64, test::Number{numbers.data()});
    for_each(device, 0, 64, test::Number{numbers.data()});
    for_each(device, 0, 0, test::Number{numbers.data()});
    EXPECT_EQ(device.launches(), (std::map<std::string, long>{{"number", 2}}));
    auto const nothing = sum_over<2>(device, 0, 0, test::Moments{nullptr});
    EXPECT_EQ(nothing, (Sums<2>{0, 0}));
    EXPECT_EQ(device.launches().count("moments"), 0u);
  }
}

TEST(Device, TimesEveryKernelWhileItIsWatched) {
  for (auto& device : every_device()) {
    Buffer<Index> numbers(device, "numbers", 64);
    Buffer<double> values(device, "values", 64);
    for_each(device, 0, 64, test::Number{numbers.data()});
    EXPECT_TRUE(device.times().empty());
    device.watch(true);
    for_each(device, 0, 64, test::Number{numbers.data()});
    EXPECT_EQ(sum_over<2>(device, 0, 64, test::Moments{values.data()}), (Sums<2>{0, 0}));
    device.watch(false);
    for_each(device, 0, 64, test::Number{numbers.data()});
    EXPECT_EQ(device.launches().at("number"), 3);
    EXPECT_EQ(device.times().size(), 2u);
    EXPECT_GT(device.times().at("number"), 0);
    EXPECT_GT(device.times().at("moments"), 0);
  }
}

TEST(Device, CountsWhatTheHostWaitsFor) {
  for (auto& device : every_device()) {
    Buffer<double> values(device, "values", std::vector<double>{1, 2, 3});
    EXPECT_EQ(device.copies(), 1);
    values.download();
    EXPECT_EQ(device.copies(), 2);
    EXPECT_EQ(device.copied_bytes(), 48u);
  }
}

TEST(Device, HasNoMoreRoomThanTheEnvironmentAllows) {
  for (auto& device : every_device()) {
    EXPECT_GT(device.room(), 1'000'000u);
    setenv("FISSURE_MEMORY", "1e5", 1);
    EXPECT_EQ(device.room(), 100'000u);
    setenv("FISSURE_MEMORY", "much", 1);
    EXPECT_EQ(error_of([&] { device.room(); }), "FISSURE_MEMORY: \"much\" is not a number of 1 or more");
    unsetenv("FISSURE_MEMORY");
  }
}

TEST(Device, OfAnotherNumberIsRefused) {
  if (!cuda::why_not(0).empty()) GTEST_SKIP() << "this machine has no GPU";
  EXPECT_EQ(cuda::why_not(99).substr(0, 19), "there is no GPU 99:");
  EXPECT_EQ(cuda::why_not(0), "");
}

TEST(Buffer, StartsWithZerosOnWholeCacheLines) {
  for (auto& device : every_device())
    for (std::size_t n : {std::size_t{1}, std::size_t{1000}, std::size_t{1} << 19}) {
      Buffer<double> const zeros(device, "zeros", n);
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(zeros.data()) % 64, 0u);
      EXPECT_EQ(zeros.download(), std::vector<double>(n, 0));
    }
}

TEST(Buffer, GivesBackWhatItGot) {
  auto const values = wild_values(1000);
  for (auto& device : every_device()) {
    Buffer<double> buffer(device, "values", values);
    EXPECT_EQ(buffer.download(), values);
    EXPECT_EQ(buffer.download_one(999), values[999]);
    buffer.upload_one(17, 4.5);
    std::vector<double> copy;
    auto const seen = buffer.look(copy);
    EXPECT_EQ(seen.size(), values.size());
    EXPECT_EQ(seen[16], values[16]);
    EXPECT_EQ(seen[17], 4.5);
    EXPECT_EQ(copy.empty(), device.backend() == Backend::cpu);  // no copy where the host can read
  }
}

TEST(Buffer, TakesAsManyValuesAsItHolds) {
  Device device = Device::select("cpu", 1);
  Buffer<double> buffer(device, "weights", 3);
  EXPECT_EQ(error_of([&] { buffer.upload({1, 2, 3, 4}); }), "array \"weights\" holds 3 values, not 4");
  EXPECT_EQ(error_of([&] { buffer.upload({}); }), "array \"weights\" holds 3 values, not 0");
  EXPECT_EQ(buffer.download(), std::vector<double>(3, 0));
}

TEST(Buffer, ThatHoldsNothingAsksForNothing) {
  Buffer<double> nothing;
  EXPECT_TRUE(nothing.empty());
  EXPECT_EQ(nothing.data(), nullptr);
  nothing.upload({});
  EXPECT_TRUE(nothing.download().empty());
  std::vector<double> copy;
  EXPECT_TRUE(nothing.look(copy).empty());
}

TEST(Buffer, MovesWithItsMemory) {
  Device device = Device::select("cpu", 1);
  Buffer<int> a(device, "a", std::vector<int>{1, 2, 3});
  int const* const at = a.data();
  Buffer<int> b = std::move(a);
  EXPECT_EQ(b.data(), at);
  b = Buffer<int>(device, "b", std::vector<int>{4});
  EXPECT_EQ(b.download(), std::vector<int>{4});
  EXPECT_EQ(device.arrays(), (std::map<std::string, std::size_t>{{"b", 4}}));
}

TEST(ForEach, VisitsEveryIndexOnce) {
  for (auto& device : every_device())
    for (Index n : {1, 15, 16, 17, 5000}) {
      Buffer<Index> numbers(device, "numbers", static_cast<std::size_t>(n) + 2);
      for_each(device, 1, n, test::Number{numbers.data()});
      auto const got = numbers.download();
      for (Index i = 0; i < n + 2; ++i) ASSERT_EQ(got[i], i <= n ? i : 0) << "of " << n << " on " << device.describe();
    }
}

template <class Real>
void scales_alike() {
  auto const values = wild_values<Real>(1 << 16);
  std::vector<Real> expected(values);
  for (auto& value : expected) value *= static_cast<Real>(0.3);
  for (auto& device : every_device()) {
    Buffer<Real> from(device, "from", values), to(device, "to", values.size());
    for_each(device, 0, static_cast<Index>(values.size()), test::Scale<Real>{from.data(), to.data(), 0.3});
    EXPECT_EQ(to.download(), expected) << device.describe();
  }
}
TEST(ForEach, GivesTheSameBitsOnEveryDevice) {
  scales_alike<double>();
  scales_alike<float>();
}

/// Sums of `values` on the device.
Sums<2> moments(Device& device, std::vector<double> const& values) {
  Buffer<double> buffer(device, "values", values);
  return sum_over<2>(device, 0, static_cast<Index>(values.size()), test::Moments{buffer.data()});
}

TEST(SumOver, IsTheSameToTheLastBitForAnyNumberOfThreadsAndEveryTime) {
  for (std::size_t n : {1u, 1023u, 1025u, 300'000u}) {
    auto const values = wild_values(n);
    Device one = Device::select("cpu", 1);
    auto const expected = moments(one, values);
    for (auto& device : every_device()) {
      auto const first = moments(device, values);
      EXPECT_EQ(moments(device, values), first) << device.describe();
      if (device.backend() == Backend::cpu) {
        EXPECT_EQ(first, expected) << n << " values, " << device.describe();
      }
    }
  }
}

TEST(SumOver, IsRightToRoundOff) {
  auto const values = wild_values(300'000);
  long double sum = 0, size = 0, squares = 0;
  for (double value : values) sum += value, size += std::abs(value), squares += static_cast<long double>(value) * value;
  for (auto& device : every_device()) {
    auto const got = moments(device, values);
    // A chunk of 1024 and the chunks after it: some 1300 roundings of at most half an ulp of the sum of sizes.
    EXPECT_NEAR(got[0], static_cast<double>(sum), 1300 * 1.2e-16 * static_cast<double>(size));
    EXPECT_NEAR(got[1], static_cast<double>(squares), 1300 * 1.2e-16 * static_cast<double>(squares));
  }
}

template <class Real>
void totals_alike() {
  auto const values = wild_values<Real>(1 << 16);
  double size = 0, expected = 0;
  for (Real value : values) expected += static_cast<double>(value), size += std::abs(static_cast<double>(value));
  for (auto& device : every_device()) {
    Buffer<Real> buffer(device, "values", values);
    auto const got = sum_over<1>(device, 0, static_cast<Index>(values.size()), test::Total<Real>{buffer.data()});
    EXPECT_NEAR(got[0], expected, 70'000 * 1.2e-16 * size) << device.describe();
  }
}
TEST(SumOver, TakesEveryLaneOfAPackInDouble) {
  totals_alike<double>();
  totals_alike<float>();
}

TEST(LargestOver, FindsTheLargestOfEachOnEveryDevice) {
  auto values = wild_values(100'000);
  for (auto& value : values) value = std::abs(value) + 1;  // all of them above zero, so that no zero may creep in
  auto const [least, most] = std::minmax_element(values.begin(), values.end());
  for (auto& device : every_device()) {
    Buffer<double> buffer(device, "values", values);
    auto const got = largest_over<2>(device, 0, static_cast<Index>(values.size()), test::Range{buffer.data()});
    EXPECT_EQ(got, (Sums<2>{*most, -*least})) << device.describe();
  }
}

}  // namespace
}  // namespace fissure
