// Discrete cosine transforms of pairs of real rows: two rows are the real and imaginary part of one complex Fourier transform.
#pragma once

#include <complex>
#include <memory>
#include <vector>

struct fftwf_plan_s;

namespace gradus {

struct FftwFree {
  void operator()(void* p) const;
};
// Memory as FFTW wants it for its vector code.
using FftBuffer = std::unique_ptr<std::complex<float>[], FftwFree>;

// X[k] = 2 Σ x[n] cos(π (2n+1) k / 2N) and its inverse without the factor 1/N, both in place (DCT-II and -III; Makhoul 1980, "A fast
// cosine transform in one and two dimensions": the even samples, then the odd ones backwards, by one Fourier transform of the same length).
class Dct {
 public:
  // Scratch of one thread.
  struct Scratch {
    explicit Scratch(int length);
    FftBuffer time, frequency;
  };

  explicit Dct(int length);
  ~Dct();
  Dct(const Dct&) = delete;
  Dct& operator=(const Dct&) = delete;

  int length() const { return length_; }
  // Any number of threads, each with its own scratch.
  void forward(float* a, float* b, Scratch* scratch) const;
  void inverse(float* a, float* b, Scratch* scratch) const;

 private:
  int length_;
  std::vector<std::complex<float>> twiddle_;  // exp(-iπk/2N)
  fftwf_plan_s* forward_ = nullptr;
  fftwf_plan_s* backward_ = nullptr;
};

}  // namespace gradus
