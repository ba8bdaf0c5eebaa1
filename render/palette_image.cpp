#include "render/palette_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace souple::render {

namespace {

using Rgb = std::array<float, 3>;  // sRGB-encoded, in [0, 255]: distances approximate perceived differences

/// All pixels whose colors agree in the upper five bits of each channel, merged.
struct Bin {
  Rgb color{};
  float pixels = 0;
};

constexpr std::size_t bin_count = 1 << 15;

std::size_t bin_of(const Rgb& color) {
  const auto upper = [](float value) { return std::size_t(std::clamp(value, 0.0f, 255.0f)) >> 3; };
  return upper(color[0]) << 10 | upper(color[1]) << 5 | upper(color[2]);
}

Rgb rgb(const std::uint8_t* pixel) {
  return {float(pixel[0]), float(pixel[1]), float(pixel[2])};
}

float distance_squared(const Rgb& a, const Rgb& b) {
  // Green contributes most to brightness, blue least.
  const float r = a[0] - b[0], g = a[1] - b[1], bl = a[2] - b[2];
  return 2 * r * r + 4 * g * g + bl * bl;
}

std::vector<Bin> bins_of(const Image& image) {
  std::vector<std::array<double, 4>> sums(bin_count);
  for (std::size_t i = 0; i < image.pixels.size(); i += 4) {
    const Rgb color = rgb(&image.pixels[i]);
    std::array<double, 4>& sum = sums[bin_of(color)];
    for (std::size_t c = 0; c < 3; ++c) sum[c] += double(color[c]);
    sum[3] += 1;
  }
  std::vector<Bin> bins;
  for (const std::array<double, 4>& sum : sums) {
    if (sum[3] == 0) continue;
    bins.push_back({{float(sum[0] / sum[3]), float(sum[1] / sum[3]), float(sum[2] / sum[3])}, float(sum[3])});
  }
  return bins;
}

/// A range of bins, and its variation along its widest channel.
struct Box {
  std::size_t begin = 0, end = 0;
  std::size_t channel = 0;
  double spread = 0;  ///< sum of squared deviations from the mean
};

Box box_of(const std::vector<Bin>& bins, std::size_t begin, std::size_t end) {
  Box box{begin, end, 0, 0};
  for (std::size_t c = 0; c < 3; ++c) {
    double sum = 0, squares = 0, pixels = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const double value = double(bins[i].color[c]), weight = double(bins[i].pixels);
      sum += weight * value;
      squares += weight * value * value;
      pixels += weight;
    }
    const double spread = squares - sum * sum / pixels;
    if (spread > box.spread) {
      box.spread = spread;
      box.channel = c;
    }
  }
  return box;
}

/// Index at which to cut a box, sorted along its channel, into halves of about equal numbers of pixels.
std::size_t cut_position(const std::vector<Bin>& bins, const Box& box) {
  float total = 0, below = 0;
  for (std::size_t i = box.begin; i < box.end; ++i) total += bins[i].pixels;
  std::size_t cut = box.begin;
  while (cut + 1 < box.end && below < total / 2) below += bins[cut++].pixels;
  return std::max(cut, box.begin + 1);
}

std::vector<Rgb> median_cut(std::vector<Bin>& bins, std::size_t count) {
  std::vector<Box> boxes{box_of(bins, 0, bins.size())};
  while (boxes.size() < count) {
    const auto worst = std::max_element(boxes.begin(), boxes.end(),
                                        [](const Box& a, const Box& b) { return a.spread < b.spread; });
    if (worst->spread <= 0 || worst->end - worst->begin < 2) break;
    const Box box = *worst;
    std::stable_sort(bins.begin() + std::ptrdiff_t(box.begin), bins.begin() + std::ptrdiff_t(box.end),
                     [&](const Bin& a, const Bin& b) { return a.color[box.channel] < b.color[box.channel]; });
    const std::size_t cut = cut_position(bins, box);
    *worst = box_of(bins, box.begin, cut);
    boxes.push_back(box_of(bins, cut, box.end));
  }
  std::vector<Rgb> colors;
  for (const Box& box : boxes) {
    std::array<double, 3> sum{};
    double pixels = 0;
    for (std::size_t i = box.begin; i < box.end; ++i) {
      for (std::size_t c = 0; c < 3; ++c) sum[c] += double(bins[i].pixels * bins[i].color[c]);
      pixels += double(bins[i].pixels);
    }
    colors.push_back({float(sum[0] / pixels), float(sum[1] / pixels), float(sum[2] / pixels)});
  }
  return colors;
}

std::size_t nearest(const std::vector<Rgb>& colors, const Rgb& color) {
  std::size_t best = 0;
  float least = std::numeric_limits<float>::max();
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const float distance = distance_squared(colors[i], color);
    if (distance < least) {
      least = distance;
      best = i;
    }
  }
  return best;
}

/// One iteration of Lloyd's method: each color moves to the mean of the pixels nearest to it.
void improve(std::vector<Rgb>& colors, const std::vector<Bin>& bins) {
  std::vector<std::array<double, 4>> sums(colors.size());
  for (const Bin& bin : bins) {
    std::array<double, 4>& sum = sums[nearest(colors, bin.color)];
    for (std::size_t c = 0; c < 3; ++c) sum[c] += double(bin.pixels * bin.color[c]);
    sum[3] += double(bin.pixels);
  }
  for (std::size_t i = 0; i < colors.size(); ++i) {
    if (sums[i][3] == 0) continue;
    for (std::size_t c = 0; c < 3; ++c) colors[i][c] = float(sums[i][c] / sums[i][3]);
  }
}

/// Error diffusion: each pixel gets the color nearest to its value plus the errors of its neighbors.
std::vector<std::uint8_t> diffuse(const Image& image, const std::vector<Rgb>& colors) {
  const auto width = std::size_t(image.width);
  std::vector<std::uint8_t> indices(width * std::size_t(image.height));
  std::vector<Rgb> here(width + 2), below(width + 2);  // accumulated errors, with one pixel of margin
  for (std::size_t y = 0; y < std::size_t(image.height); ++y) {
    const bool rightwards = y % 2 == 0;  // alternating directions avoid slanted patterns
    for (std::size_t step = 0; step < width; ++step) {
      const std::size_t x = rightwards ? step : width - 1 - step;
      const std::size_t ahead = rightwards ? x + 2 : x, behind = rightwards ? x : x + 2;
      Rgb wanted = rgb(image.at(int(x), int(y)));
      for (std::size_t c = 0; c < 3; ++c) wanted[c] = std::clamp(wanted[c] + here[x + 1][c], 0.0f, 255.0f);
      const std::size_t index = nearest(colors, wanted);
      indices[y * width + x] = std::uint8_t(index);
      for (std::size_t c = 0; c < 3; ++c) {
        const float missed = (wanted[c] - colors[index][c]) / 16;
        here[ahead][c] += 7 * missed;
        below[behind][c] += 3 * missed;
        below[x + 1][c] += 5 * missed;
        below[ahead][c] += missed;
      }
    }
    here.swap(below);
    std::fill(below.begin(), below.end(), Rgb{});
  }
  return indices;
}

}  // namespace

PaletteImage reduce_colors(const Image& image, int count) {
  std::vector<Bin> bins = bins_of(image);
  std::vector<Rgb> colors = median_cut(bins, std::size_t(count));
  for (int round = 0; round < 4; ++round) improve(colors, bins);
  PaletteImage result;
  for (Rgb& color : colors) {
    for (float& channel : color) {
      channel = std::round(channel);
      result.colors.push_back(std::uint8_t(channel));
    }
  }
  result.indices = diffuse(image, colors);
  return result;
}

}  // namespace souple::render
