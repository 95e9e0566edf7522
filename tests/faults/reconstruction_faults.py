"""Faults in feature-based reconstruction: half-buffers, features, variances and the frozen operator."""

from __future__ import annotations

from fault import Fault, native

REGULARIZED = "native/src/reconstruct/regularized.cpp"
HALVED_IMAGE = "native/src/reconstruct/halved_image.h"
FUSED = "native/src/reconstruct/fused_differences.cpp"
LINEAR_PARTS = "native/src/reconstruct/linear_terms.h"
REGRESS_CHANGE = "native/src/reconstruct/space_time/regress_change.cpp"
REGULARIZED_WINDOWS = "native/src/reconstruct/space_time/regularized_windows.cpp"
FEATURE_REGRESSION = "native/src/reconstruct/feature_regression.cpp"
REGRESSION_ERROR = "native/src/reconstruct/regression_error.cpp"
LOCAL_REGRESSION = "native/src/reconstruct/local_regression.cpp"
TILE = "native/src/reconstruct/regression_tile.h"
ERROR_ESTIMATE = "native/src/reconstruct/error_estimate.cpp"
FEATURE_FILTER = "native/src/reconstruct/feature_filter.cpp"
FEATURES = "native/src/film/features.cpp"
READ = "native/src/film/read.cpp"

OF_FEATURES = (native("Features.HalvesAverageToThePass"),)
OF_FILTER = (native("FeatureFilter.DifferencesCountByTheVariance"),)
KEEPS_FEATURES = (native("B2_Regularized.KeepsWhatTheFeaturesExplain"),)
OF_ERROR = (native("B2_Regularized.ErrorIsVarianceAndSquaredBias"),)
OF_PARTS = (native("A8_RegressionError.*"),)
OF_SHARES = (native("B2_Regression.PixelsAndWindowsCountByTheirErrors"),)
OF_PIXELS = (native("B2_Regularized.BelievesPixelsByTheirVariance"),)
OF_DIFFERENCES = (native("B2_Regularized.DifferencesCountByTheirVariance"),)
GIVES_BACK = (native("B2_Regularized.GivesBackTheLightOfRareSamples"),)
OF_ALPHA = (native("B2_Regularized.AlphaGoesThroughTheSameWeights"),)
OF_ESTIMATE = (native("ErrorEstimate.OfHalvesApartIsTheSquareOfHalfTheirDistance"),)

HALVES = "half-buffers mixed"
SHIFT = "features shifted"
VARIANCE = "variance off by 4"
SECOND_STEP = "second step dropped"
FROZEN = "alpha does not go through the frozen operator"
COMPONENTS = "components inconsistent with the image"
OF_COMPONENTS = (native("B2_Regularized.ComponentsAreWhatThePictureWithoutThemIsMadeOf"),)

RECONSTRUCTION = (
    Fault(
        13,
        HALVES,
        "half-buffer A is read in place of B, so that no noise is seen",
        REGULARIZED,
        "Rgb(component.primal[1][pixel])",
        "Rgb(component.primal[0][pixel])",
        (native("B2_Regularized.TakesMostOfTheNoise"), *OF_ERROR),
    ),
    Fault(
        13,
        HALVES,
        "their sum is taken in place of their difference",
        HALVED_IMAGE,
        "0.5f * (sums[0][c] / a - sums[1][c] / b)",
        "0.5f * (sums[0][c] / a + sums[1][c] / b)",
        OF_ERROR,
    ),
    Fault(
        13,
        HALVES,
        "the mean is regressed as if it were the difference",
        LOCAL_REGRESSION,
        "{&mean, &half_difference}",
        "{&mean, half_difference.width() > 0 ? &mean : &half_difference}",
        (native("B2_Regression.KnowsItsNoise"), *OF_SHARES),
    ),
    Fault(
        13,
        HALVES,
        "the residual's noise counts as bias, not against it",
        TILE,
        "(!Estimates || c < kChannels ? 1.0f : -1.0f) * values",
        "values",
        OF_SHARES,
    ),
    Fault(
        13,
        HALVES,
        "the second step takes the image for its noise",
        FEATURE_REGRESSION,
        "of_noise = difference(image.half_difference, first->noise);",
        "of_noise = difference(image.mean, first->noise);",
        OF_ERROR,
    ),
    Fault(
        13,
        HALVES,
        "half-buffer A of a feature is added twice",
        FEATURES,
        "sum += plane.values[h][plane.channels * pixel + c];",
        "sum += plane.values[0][plane.channels * pixel + c];",
        OF_FEATURES,
    ),
    Fault(
        13,
        HALVES,
        "half-buffer B of a feature is divided by the sample count of A",
        FEATURES,
        "plane.values[1][i] / static_cast<float>(b)",
        "plane.values[1][i] / static_cast<float>(a)",
        OF_FEATURES,
    ),
    Fault(
        13,
        HALVES,
        "the sum of the half-buffers is read in place of their difference",
        READ,
        "row[i] = 0.5f * (row[i] - other[i]);",
        "row[i] = 0.5f * (row[i] + other[i]);",
        OF_ESTIMATE,
    ),
    Fault(
        13,
        HALVES,
        "the error of L2 is computed from the image in place of the half-buffer difference",
        ERROR_ESTIMATE,
        "ErrorTerms terms{reconstruct(differences, GRADUS_RECONSTRUCTION_L2, alpha, cancel, &report), {}};",
        "ErrorTerms terms{reconstruct(film, component, GRADUS_RECONSTRUCTION_L2, alpha, cancel, &report), {}};",
        OF_ESTIMATE,
    ),
    Fault(
        14,
        SHIFT,
        "all features, by one pixel",
        FEATURE_REGRESSION,
        "const size_t i = size_t(y) * size_t(features.width) + size_t(x);",
        "const size_t i = size_t(y) * size_t(features.width) + size_t(std::min(x + 1, features.width - 1));",
        KEEPS_FEATURES,
    ),
    Fault(
        14,
        SHIFT,
        "the albedo of the second step, by one pixel",
        FEATURE_REGRESSION,
        "features.albedo.values[3 * (size_t(y) * size_t(features.width) + size_t(x)) + size_t(c)]",
        "features.albedo.values[3 * (size_t(y) * size_t(features.width) + size_t(std::max(x - 1, 0))) + size_t(c)]",
        GIVES_BACK,
    ),
    Fault(
        14,
        SHIFT,
        "the features of a window, by one row",
        TILE,
        "task_.features->row(y, c)",
        "task_.features->row(std::max(y - 1, 0), c)",
        (native("B1_Regression.KeepsWhatTheFeaturesExplain"), *KEEPS_FEATURES),
    ),
    Fault(
        14,
        SHIFT,
        "all features, by one pixel as they are read",
        FEATURES,
        "read_mean(film, *plane, halves, i, image.values.data() + i * image.channels);",
        "read_mean(film, *plane, halves, i > 0 ? i - 1 : 0, image.values.data() + i * image.channels);",
        (*OF_FEATURES, *KEEPS_FEATURES),
    ),
    Fault(
        14,
        SHIFT,
        "the filter's distances to the left and lower neighbours, by one pixel",
        FEATURE_FILTER,
        "distance.row(other) + step - first_column(offset);",
        "distance.row(other) - first_column(offset);",
        (native("FeatureFilter.AMirroredPictureIsFilteredAlike"),),
    ),
    Fault(
        15,
        VARIANCE,
        "the variance of the image is four times too large",
        HALVED_IMAGE,
        "0.5f * (sums[0][c] / a - sums[1][c] / b)",
        "sums[0][c] / a - sums[1][c] / b",
        OF_ERROR,
    ),
    Fault(
        15,
        VARIANCE,
        "the variance of the image is a quarter of the true value",
        HALVED_IMAGE,
        "0.5f * (sums[0][c] / a - sums[1][c] / b)",
        "0.25f * (sums[0][c] / a - sums[1][c] / b)",
        OF_ERROR,
    ),
    Fault(
        15,
        VARIANCE,
        "the variance of a pixel's own value is four times too large",
        FEATURE_REGRESSION,
        "kOwnTrust / (expected * expected * doubt * doubt + kMinVariance)",
        "kOwnTrust / (4.0f * expected * expected * doubt * doubt + kMinVariance)",
        OF_PIXELS,
    ),
    Fault(
        15,
        VARIANCE,
        "the variance of a pixel's own value is a quarter of the true value",
        FEATURE_REGRESSION,
        "kOwnTrust / (expected * expected * doubt * doubt + kMinVariance)",
        "kOwnTrust / (0.25f * expected * expected * doubt * doubt + kMinVariance)",
        OF_PIXELS,
    ),
    Fault(
        15,
        VARIANCE,
        "the variance of a window's estimate is four times too large",
        TILE,
        "(noise > zero ? unit * noise : zero)",
        "(noise > zero ? 4.0f * unit * noise : zero)",
        OF_SHARES,
    ),
    Fault(
        15,
        VARIANCE,
        "the variance of a window's estimate is a quarter of the true value",
        TILE,
        "(noise > zero ? unit * noise : zero)",
        "(noise > zero ? 0.25f * unit * noise : zero)",
        OF_SHARES,
    ),
    Fault(
        15,
        VARIANCE,
        "the squared bias of a window is four times too large",
        TILE,
        "bias = unit * residual;",
        "bias = 4.0f * unit * residual;",
        OF_SHARES,
    ),
    Fault(
        15,
        VARIANCE,
        "the variance of regressed differences is four times too large",
        FUSED,
        "0.5f * kSharedDifference * both",
        "2.0f * kSharedDifference * both",
        OF_DIFFERENCES,
    ),
    Fault(
        15,
        VARIANCE,
        "the variance of sampled differences is a quarter of the true value",
        READ,
        "rows.sampled[x] ? 0.5f * std::sqrt(sum / 3.0f)",
        "rows.sampled[x] ? 0.25f * std::sqrt(sum / 3.0f)",
        OF_DIFFERENCES,
    ),
    Fault(
        15,
        VARIANCE,
        "the variance of a feature is four times too large",
        FEATURES,
        "const float half = 0.5f * (plane.values[0]",
        "const float half = (plane.values[0]",
        OF_FEATURES,
    ),
    Fault(
        15,
        VARIANCE,
        "the variance of a feature is a quarter of the true value",
        FEATURES,
        "const float half = 0.5f * (plane.values[0]",
        "const float half = 0.25f * (plane.values[0]",
        OF_FEATURES,
    ),
    Fault(
        15,
        VARIANCE,
        "the variance in the feature filter is four times too large",
        FEATURE_FILTER,
        "noise = of_a[x] + of_b[x];",
        "noise = 4.0f * (of_a[x] + of_b[x]);",
        OF_FILTER,
    ),
    Fault(
        15,
        VARIANCE,
        "the variance in the feature filter is a quarter of the true value",
        FEATURE_FILTER,
        "noise = of_a[x] + of_b[x];",
        "noise = 0.25f * (of_a[x] + of_b[x]);",
        OF_FILTER,
    ),
    Fault(
        15,
        VARIANCE,
        "the scale in the pass Error is not squared",
        REGULARIZED,
        "value *= scale * scale;",
        "value *= scale;",
        (native("B2_Regularized.ScalesWithTheImage"),),
    ),
    Fault(
        15,
        VARIANCE,
        "the pass Error omits the bias",
        REGRESSION_ERROR,
        "std::max(bias.row(y)[x], 0.0f)",
        "std::min(bias.row(y)[x], 0.0f)",
        OF_ERROR,
    ),
    Fault(
        15,
        VARIANCE,
        "the pass Error includes bias below 0",
        REGRESSION_ERROR,
        "std::max(bias.row(y)[x], 0.0f)",
        "bias.row(y)[x]",
        OF_PARTS,
    ),
    Fault(
        15,
        VARIANCE,
        "the noise in the pass Error is not relative to the light",
        REGRESSION_ERROR,
        " / light.row(y)[x]; }",
        "; }",
        OF_PARTS,
    ),
    Fault(15, VARIANCE, "the pass Error omits lost light", REGRESSION_ERROR, " + kLost * lost.row(y)[x]", "", OF_PARTS),
    Fault(
        15,
        VARIANCE,
        "the pass Error omits the noise of the second step",
        FEATURE_REGRESSION,
        "  add(second.noise, &first->noise);\n",
        "",
        GIVES_BACK,
    ),
    Fault(
        15,
        VARIANCE,
        "the half-buffer difference in the pass Error of L2 is not halved",
        READ,
        "row[i] = 0.5f * (row[i] - other[i]);",
        "row[i] = row[i] - other[i];",
        OF_ESTIMATE,
    ),
    Fault(
        16,
        SECOND_STEP,
        "the image lacks the second step",
        FEATURE_REGRESSION,
        "  add(second.mean, &first->mean);\n",
        "",
        GIVES_BACK,
    ),
    Fault(
        16,
        SECOND_STEP,
        "other channels that go through the weights lack the second step",
        FEATURE_REGRESSION,
        "  add(of_residual_.apply(residual, cancel), &result);\n",
        "",
        OF_ALPHA,
    ),
    Fault(
        17,
        FROZEN,
        "alpha stays as noisy as it was sampled",
        REGULARIZED,
        "regression_->apply(channels_of(read_sampled(film, 0, scale_), 3, 1), cancel)",
        "channels_of(read_sampled(film, 0, scale_), 3, 1)",
        OF_ALPHA,
    ),
    Fault(
        17,
        FROZEN,
        "beside differences, alpha is that of the regression alone",
        FUSED,
        "  solve();\n}\n",
        "  solve();\n"
        "  for_values(&solution_, [&](float& v, int x, int y, int c) { v = c < 3 ? v : regressed.row(y, c)[x]; });\n}\n",
        OF_ALPHA,
    ),
    Fault(
        17,
        FROZEN,
        "outliers of alpha keep all of their light",
        FEATURE_REGRESSION,
        "Field residual = difference(values, result);\n"
        "  scale_by(residual_share_, &residual);\n",
        "Field residual = difference(values, result);\n",
        OF_ALPHA,
    ),
    Fault(
        17,
        FROZEN,
        "large windows do not contribute to alpha",
        FEATURE_REGRESSION,
        "  blend(share_, coarse_.apply(values, cancel), &result);\n",
        "",
        OF_ALPHA,
    ),
    Fault(
        17,
        FROZEN,
        "the own values of pixels do not contribute to alpha",
        TILE,
        "load(boxes_[c] + x) + own *",
        "load(boxes_[c] + x) + (Estimates ? own : zero) *",
        (native("B2_Regression.IsTheFrozenOperatorThatItApplies"), *OF_ALPHA),
    ),
    Fault(
        33,
        COMPONENTS,
        "the remainder of the other components is not subtracted from the brightest",
        LINEAR_PARTS,
        "    subtract((*terms)[k], &left);\n",
        "",
        OF_COMPONENTS,
    ),
    Fault(
        33,
        COMPONENTS,
        "beside differences, components are those of the regression alone",
        REGULARIZED,
        "fusion_ ? fusion_->apply(film::read_images(film, component), regressed, cancel_, report_) : regressed",
        "component < 0 ? fusion_->apply(film::read_images(film, component), regressed, cancel_, report_) : regressed",
        (native("B2_Regularized.ComponentsGoThroughOneLinearOperator"),),
    ),
    Fault(
        33,
        COMPONENTS,
        "all components follow the correspondence of the first",
        REGULARIZED_WINDOWS,
        "window[t]->change->correspondence[k], window",
        "window[t]->change->correspondence[0], window",
        (native("B2_RegularizedWindow.EveryComponentGoesItsOwnWay"),),
    ),
    Fault(
        33,
        COMPONENTS,
        "changes of components are not added before they are weighted",
        REGRESS_CHANGE,
        "      add(component.image.half_difference, &sum.half_difference);\n",
        "",
        (native("B2_RegularizedWindow.ComponentsThatGoTheSameWayAreWhatTheirSumBecomes"),),
    ),
)
