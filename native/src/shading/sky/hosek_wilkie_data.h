// Coefficients of "An Analytic Model for Full Spectral Sky-Dome Radiance" (Hosek and Wilkie 2012), data for CIE XYZ,
// version 1.4a, to seven digits, from the authors' sample implementation (ArHosekSkyModelData_CIEXYZ.h), which comes
// with this notice:
//
// This source is published under the following 3-clause BSD license.
//
// Copyright (c) 2012 - 2013, Lukas Hosek and Alexander Wilkie
// All rights reserved.
//
// Redistribution and use in source and binary forms, with or without
// modification, are permitted provided that the following conditions are met:
//
//     * Redistributions of source code must retain the above copyright
//       notice, this list of conditions and the following disclaimer.
//     * Redistributions in binary form must reproduce the above copyright
//       notice, this list of conditions and the following disclaimer in the
//       documentation and/or other materials provided with the distribution.
//     * None of the names of the contributors may be used to endorse or promote
//       products derived from this software without specific prior written
//       permission.
//
// THIS SOFTWARE IS PROVIDED BY THE COPYRIGHT HOLDERS AND CONTRIBUTORS "AS IS" AND
// ANY EXPRESS OR IMPLIED WARRANTIES, INCLUDING, BUT NOT LIMITED TO, THE IMPLIED
// WARRANTIES OF MERCHANTABILITY AND FITNESS FOR A PARTICULAR PURPOSE ARE
// DISCLAIMED. IN NO EVENT SHALL THE COPYRIGHT HOLDERS BE LIABLE FOR ANY
// DIRECT, INDIRECT, INCIDENTAL, SPECIAL, EXEMPLARY, OR CONSEQUENTIAL DAMAGES
// (INCLUDING, BUT NOT LIMITED TO, PROCUREMENT OF SUBSTITUTE GOODS OR SERVICES;
// LOSS OF USE, DATA, OR PROFITS; OR BUSINESS INTERRUPTION) HOWEVER CAUSED AND
// ON ANY THEORY OF LIABILITY, WHETHER IN CONTRACT, STRICT LIABILITY, OR TORT
// (INCLUDING NEGLIGENCE OR OTHERWISE) ARISING IN ANY WAY OUT OF THE USE OF THIS
// SOFTWARE, EVEN IF ADVISED OF THE POSSIBILITY OF SUCH DAMAGE.
// */
#pragma once

namespace gradus::shading {

// Coefficients of one channel, indexed by ground albedo (0, 1), turbidity (1…10) and control point of the solar
// elevation; for the shape also by its nine parameters.
struct HosekWilkieTable {
  float shape[2 * 10 * 6 * 9];
  float scale[2 * 10 * 6];
};

extern const HosekWilkieTable kHosekWilkieX, kHosekWilkieY, kHosekWilkieZ;

}  // namespace gradus::shading
