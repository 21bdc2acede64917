"use strict";
// The page's colours, on white and, on a screen that is dark, on black. Paper is white.

const darkness = matchMedia("screen and (prefers-color-scheme: dark)");
let printing = false;
const isDark = () => darkness.matches && !printing;
// A colour of the run's data, as it is on the ground that the page has now.
const seen = (onBoth) => onBoth[isDark() ? 1 : 0];
const GROUND = { ground: ["#ffffff", "#16171a"], ink: ["#1a1a1a", "#e6e6e6"], line: ["#444444", "#9a9aa2"], grid: ["#e4e4e8", "#2c2d33"] };
const ground = (name) => seen(GROUND[name]);

const rgb = (color) => [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16));
const mixed = (from, to, share) => `rgb(${rgb(from).map((part, at) => Math.round(part + (rgb(to)[at] - part) * share)).join(",")})`;

// Numbers as the command prints them: 12 345.
const grouped = (number) => String(Math.round(number)).replace(/\B(?=(\d{3})+$)/g, " ");
const figure = (value) => `${+value.toPrecision(4)}`;
const memo = (make) => { let made; return () => made ??= make(); };
const element = (name, attributes, ...children) => {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
};

// A button that does something.
function button(text, hint, action) {
  const made = element("button", { type: "button", title: hint, "aria-label": hint }, text);
  made.addEventListener("click", action);
  return made;
}
