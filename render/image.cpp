#include "render/image.h"

#include "render/srgb.h"
#include "souple/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

namespace souple::render {

namespace {

/// Per target pixel i: the first source pixel that it covers, and the weights of that and the following ones.
struct Cover {
  int begin = 0;
  std::vector<float> weights;  ///< sum to 1
};

std::vector<Cover> covers(int from, int to) {
  std::vector<Cover> result(static_cast<std::size_t>(to));
  const double step = double(from) / to;
  for (int i = 0; i < to; ++i) {
    Cover& cover = result[std::size_t(i)];
    const double lo = i * step, hi = (i + 1) * step;
    cover.begin = int(lo);
    for (int k = cover.begin; k < from && k < hi - 1e-9; ++k) {
      cover.weights.push_back(float((std::min(hi, k + 1.0) - std::max(lo, double(k))) / step));
    }
  }
  return result;
}

}  // namespace

Image downscale(const Image& image, int width, int height) {
  if (width < 1 || height < 1 || width > image.width || height > image.height) {
    throw Error(fmt::format("downscale: {} x {} pixels from {} x {}; expected 1 x 1 up to that size", width,
                            height, image.width, image.height));
  }
  std::array<float, 256> linear{};
  for (std::size_t i = 0; i < 256; ++i) linear[i] = linear_of_srgb(float(i) / 255);
  const std::vector<Cover> columns = covers(image.width, width), rows = covers(image.height, height);
  Image result(width, height);
  for (int y = 0; y < height; ++y) {
    const Cover& down = rows[std::size_t(y)];
    for (int x = 0; x < width; ++x) {
      const Cover& across = columns[std::size_t(x)];
      std::array<float, 4> sum{};
      for (std::size_t j = 0; j < down.weights.size(); ++j) {
        for (std::size_t i = 0; i < across.weights.size(); ++i) {
          const float weight = down.weights[j] * across.weights[i];
          const std::uint8_t* pixel = image.at(across.begin + int(i), down.begin + int(j));
          for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * linear[pixel[c]];
          sum[3] += weight * float(pixel[3]) / 255;
        }
      }
      for (std::size_t c = 0; c < 3; ++c) sum[c] = srgb_of_linear(std::min(sum[c], 1.0f));
      for (std::size_t c = 0; c < 4; ++c) {
        result.at(x, y)[c] = std::uint8_t(std::lround(std::min(sum[c], 1.0f) * 255));
      }
    }
  }
  return result;
}

void paste(const Image& from, Image& to, int x, int y) {
  const int left = std::max(x, 0), right = std::min(x + from.width, to.width);
  if (left >= right) return;
  for (int row = std::max(y, 0); row < std::min(y + from.height, to.height); ++row) {
    std::memcpy(to.at(left, row), from.at(left - x, row - y), 4 * std::size_t(right - left));
  }
}

}  // namespace souple::render
