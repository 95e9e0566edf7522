"""Published reconstructions, reimplemented for reading, with which compare_designs.py compares Gradus' own,
and compare_animated_designs.py its animations (svgf.py and nfor.py say how these were read).

How chapter 8 of the thesis (Manzi, Vicini, Zwicker 2016) was read; equations and figures are those of the chapter.

- Solver: five reweightings as in figure 4. Each system is solved exactly by a banded Cholesky factor instead of 500
  steps of conjugate gradients. The same factor serves both half-buffers and all channels, because residuals are
  weighted by their norm over the channels.
- Equation 4 has α I^g on its right-hand side where equation 3 implies α² I^g; α² is used. Line 11 of figure 4 lacks the
  half of x̂ + x̌.
- W is 1/‖e‖ in AᵀW²A as printed. A row then contributes the same at any residual, which is no L1 norm; W² = 1/‖e‖ is,
  and the authors' released solver uses it. Both are implemented (`poisson.Reweighting`).
- Lines 15 and 16 of figure 4 set the weights of pixels to 1 and then scale all weights to a mean of 1. A common scale
  changes nothing, so α would depend on the unit of light. Here the other rows are scaled to a mean of 1, beside pixels
  of 1.
- k_f = ∞ in the solve: the weights of patches depend on color alone.
- τ has a floor of 10⁻⁶ of the largest singular value, for features without noise. Variances are the larger of raw and
  blurred ones.
- Pixels that are dropped from a patch leave zeros in the rows of its basis; pixels outside the image are dropped.
- Feature filter: each channel by its own distances. Post filter: the size of its window is unreadable in our copy; it
  is 11×11, as in the feature filter. "f = 25" of the bias estimate is read as 25×25 pixels, with weights from L1.
- L1: pixels and differences are reweighted 20 times, α is 0.2, and 0.05 · 0.5^(k−1) is added to the residuals.
- Position is replaced by depth and the pixel's place, and ambient occlusion is left out.
- "Tuned" α, β and k_c were chosen among 27 scales by the error of blends on hero, kitchen, door-ajar and cornell.

NFOR has the parameters of its authors' code. Slopes are damped by 10⁻³ of the window's weight instead of a cut of small
singular values. "L1 of the other half as a feature" is how gradients are given to it.
"""
