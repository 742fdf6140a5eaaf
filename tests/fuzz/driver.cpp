// Runs a fuzz target without a fuzzer: each seed as it is, then random cuts, copies and changes of bytes until the time
// is over. Options are libFuzzer's; those that it does not know are ignored.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size);

namespace {

using Text = std::vector<std::uint8_t>;

void mutate(Text& text, std::mt19937_64& random) {
  auto const place = [&] { return text.empty() ? 0 : random() % text.size(); };
  for (auto changes = 1 + random() % 8; changes > 0; --changes) {
    auto const at = static_cast<std::ptrdiff_t>(place()), length = static_cast<std::ptrdiff_t>(random() % 32);
    auto const end = std::min<std::ptrdiff_t>(at + length, static_cast<std::ptrdiff_t>(text.size()));
    switch (random() % 4) {
      case 0:
        text.erase(text.begin() + at, text.begin() + end);
        break;
      case 1: {
        Text const piece(text.begin() + at, text.begin() + end);
        text.insert(text.begin() + static_cast<std::ptrdiff_t>(place()), piece.begin(), piece.end());
        break;
      }
      case 2:
        text.insert(text.begin() + at, static_cast<std::uint8_t>(random()));
        break;
      default:
        if (!text.empty()) text[place()] = static_cast<std::uint8_t>(random());
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  constexpr std::string_view time_option = "-max_total_time=";
  double seconds = 10;
  std::vector<Text> seeds = {{}};
  for (int i = 1; i < argc; ++i) {
    std::string const word = argv[i];
    if (word.starts_with(time_option)) seconds = std::strtod(word.c_str() + time_option.size(), nullptr);
    if (word.starts_with("-")) continue;
    for (auto const& entry : std::filesystem::directory_iterator(word)) {
      std::ifstream file(entry.path(), std::ios::binary);
      seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
  }
  for (auto const& seed : seeds) LLVMFuzzerTestOneInput(seed.data(), seed.size());

  std::mt19937_64 random(1);
  auto const end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  long runs = 0;
  for (; std::chrono::steady_clock::now() < end; ++runs) {
    Text text = seeds[random() % seeds.size()];
    mutate(text, random);
    LLVMFuzzerTestOneInput(text.data(), text.size());
  }
  std::printf("%zu seeds, %ld mutations\n", seeds.size(), runs);
  return 0;
}
