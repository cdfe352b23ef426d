// Style of the page, for phone and desktop, light and dark.
#pragma once

namespace pocketray {

// clang-format off
constexpr char kPageStyle[] = R"css(
:root { color-scheme: light dark; --ink: #1b1d22; --soft: #62666f; --paper: #ffffff; --card: #f4f5f7; --line: #dcdfe4;
  --mark: #0063a6; --glow: #fff4d6; }
@media (prefers-color-scheme: dark) { :root { --ink: #e9eaed; --soft: #a2a7b1; --paper: #15171b; --card: #1e2126;
  --line: #363a42; --mark: #6cb8f0; --glow: #3a321c; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1rem; max-width: 76rem; background: var(--paper); color: var(--ink);
  font: 1rem/1.5 system-ui, sans-serif; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 0 0 .4rem; }
h2 { font-size: 1.35rem; margin: 2.4rem 0 .6rem; padding-top: .8rem; border-top: 1px solid var(--line); }
p { margin: .4rem 0 .8rem; max-width: 46rem; }
a { color: var(--mark); text-decoration: none; }
small, .soft { color: var(--soft); font-size: .85em; }
header { display: flex; flex-wrap: wrap; gap: 1rem 1.5rem; align-items: flex-start; }
header > div { flex: 1 1 20rem; }
header figure { margin: .4rem 0; }
header img { display: block; width: 320px; max-width: 100%; border-radius: 6px; image-rendering: pixelated; }
.answer { background: var(--card); border-left: 4px solid var(--mark); border-radius: 4px; padding: .7rem 1rem;
  max-width: none; font-size: 1.1rem; }
figure { margin: .8rem 0; }
figcaption { color: var(--soft); font-size: .85rem; }
.plot { max-width: 42rem; margin: .8rem 0; }
.pair { display: flex; flex-wrap: wrap; gap: 0 2rem; align-items: flex-start; }
.pair > .box { max-width: 100%; }
.pair > .plot { flex: 1 1 28rem; min-width: 0; }
.plot svg { display: block; width: 100%; height: auto; }
.plot [color="black"] { color: var(--ink); }
.plot [fill="black"], .plot [fill="rgb(0,0,0)"] { fill: var(--ink); }
.plot [stroke="rgb(  0,   0,   0)"] { stroke: var(--ink); }
.plot [stroke="rgb(221, 221, 221)"] { stroke: var(--line); }
.box { overflow-x: auto; margin: .6rem 0; }
.strip img { display: block; width: 100%; min-width: 52rem; border-radius: 4px; }
.scale { display: inline-block; width: 8rem; height: .7rem; vertical-align: middle; border-radius: 2px; }
.tiles { display: grid; grid-template-columns: repeat(auto-fill, minmax(15rem, 1fr)); gap: 0 1rem; }
.tiles img { display: block; width: 100%; border-radius: 4px; image-rendering: pixelated; }
.quality { grid-template-columns: repeat(auto-fill, minmax(10.5rem, 1fr)); }
.quality figcaption > * { display: block; }
.quality figcaption > b, .quality a { font-size: 1rem; color: var(--ink); }
.quality a { text-decoration: underline var(--line); text-underline-offset: .2em; font-variant-numeric: tabular-nums; }
.quality a b { margin-right: .4rem; white-space: nowrap; }
.quality code { color: var(--mark); margin: .2rem 0; }
.quality small span { display: inline-block; margin-right: .4rem; font: .75rem/1.4 monospace; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .92rem; }
th, td { padding: .3rem .6rem .3rem 0; text-align: left; vertical-align: top; border-bottom: 1px solid var(--line); }
td { white-space: nowrap; }
thead th { font-weight: 500; color: var(--soft); font-size: .85rem; vertical-align: bottom; }
tbody th { font-weight: 600; min-width: 5rem; position: sticky; left: 0; background: var(--paper); }
tbody th small { display: inline-block; max-width: 7.5rem; }
.name { white-space: normal; }
.name span { display: inline-block; min-width: 8rem; max-width: 15rem; }
.key { color: var(--mark); }
.weak, .weak a, .missing { color: var(--soft); }
.weak .key { color: inherit; }
.standard, .standard th { background: var(--glow); }
nav a { display: inline-block; margin: 0 .5rem .3rem 0; padding: .1rem .6rem; border: 1px solid var(--line);
  border-radius: 1rem; font-size: .9rem; }
)css";
// clang-format on

}  // namespace pocketray
