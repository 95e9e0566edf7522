// Moves the border between two pictures, exchanges them by the lists above, and shows a crop of both.
for (const slider of document.querySelectorAll(".slider")) {
  const [left, right] = slider.querySelectorAll(".picture"), view = slider.querySelector(".view");
  const over = slider.querySelector(".over"), border = slider.querySelector(".border"), range = slider.querySelector("input");
  const [under, above] = slider.querySelectorAll(".pair img");
  range.addEventListener("input", () => {
    const share = range.value / 10;
    over.style.clipPath = `inset(0 ${100 - share}% 0 0)`;
    border.style.left = `${share}%`;
  });
  left.addEventListener("change", () => { above.src = left.value; });
  right.addEventListener("change", () => { under.src = right.value; });
  view.addEventListener("change", () => { under.style.transform = above.style.transform = view.value; });
}
