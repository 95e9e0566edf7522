// Moves the border between two pictures, and exchanges them by the lists above.
for (const slider of document.querySelectorAll(".slider")) {
  const [left, right] = slider.querySelectorAll("select");
  const over = slider.querySelector(".over"), under = slider.querySelector(".pair img:not(.over)");
  const border = slider.querySelector(".border"), range = slider.querySelector("input");
  range.addEventListener("input", () => {
    const share = range.value / 10;
    over.style.clipPath = `inset(0 ${100 - share}% 0 0)`;
    border.style.left = `${share}%`;
  });
  left.addEventListener("change", () => { over.src = left.value; });
  right.addEventListener("change", () => { under.src = right.value; });
}
