// Discrete cosine transforms of pairs of real rows: two rows are the real and imaginary part of one complex Fourier
// transform.
#pragma once

#include <complex>
#include <limits>
#include <memory>
#include <vector>

struct fftwf_plan_s;

namespace gradus::reconstruct {

struct FftwFree {
  void operator()(void* p) const;
};
// Memory with the alignment that FFTW's vector code needs.
using FftBuffer = std::unique_ptr<std::complex<float>[], FftwFree>;

// Transforms rows of `length` values: X[k] = 2 Σ x[n] cos(π (2n+1) k / 2N), and its inverse without the factor 1/N,
// both in place (DCT-II and -III; Makhoul 1980, "A fast cosine transform in one and two dimensions": the even samples,
// then the odd ones backwards, by one Fourier transform of the same length).
class Dct {
 public:
  // Work space of one thread.
  struct Scratch {
    explicit Scratch(int length);
    FftBuffer time, frequency;
  };

  explicit Dct(int length);
  ~Dct();
  Dct(const Dct&) = delete;
  Dct& operator=(const Dct&) = delete;

  int length() const { return length_; }
  // Transform the rows a and b in place. Thread-safe if each thread has its own scratch.
  void forward(float* a, float* b, Scratch* scratch) const;
  void inverse(float* a, float* b, Scratch* scratch) const;

  // Returns the index in scratch->time at which x[i] of both rows lies.
  int place(int i) const { return i % 2 == 0 ? i / 2 : length_ - 1 - i / 2; }
  // Filters the pair of rows in scratch->time: transforms them, multiplies by gain_a[k] and gain_b[k], and transforms
  // them back. `sum_a` is Σx of row a where the caller knows it more exactly than by sums of floats, else kUnknownSum.
  static constexpr double kUnknownSum = std::numeric_limits<double>::quiet_NaN();
  void filter(const float* gain_a, const float* gain_b, double sum_a, Scratch* scratch) const;

 private:
  int length_;
  std::vector<std::complex<float>> twiddle_;  // exp(-iπk/2N)
  fftwf_plan_s* forward_ = nullptr;
  fftwf_plan_s* backward_ = nullptr;
};

}  // namespace gradus::reconstruct
