// The page's style sheet: one set of colours for light and one for dark surroundings; everything else derives from
// them.
#pragma once

namespace probewalk {

inline constexpr const char* kReportStyle = R"css(
:root { color-scheme: light dark; --paper: #fbfbf9; --ink: #1d1f21; --soft: #63676c; --rule: #dcdcd6; --card: #ffffff;
  --frame: #9aa3ad; --frame-fill: #e4e7ea; --cpu: #1f6fc4; --gpu: #d9661f; --missed: #c3262f; --discarded: #8a4fc0;
  --warn-paper: #fff3d6; --warn-rule: #d99a00; --good: #2b7a3d; --fine: #b9cfc0; }
@media (prefers-color-scheme: dark) { :root { --paper: #16181b; --ink: #e7e8ea; --soft: #a0a5ab; --rule: #34383d;
  --card: #1d2024; --frame: #7c858f; --frame-fill: #2c3137; --cpu: #6cb0f5; --gpu: #f59457; --missed: #ff6b70;
  --discarded: #c39af0; --warn-paper: #3a2f12; --warn-rule: #d9a43a; --good: #74c788; --fine: #3c5746; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 15px/1.5 system-ui, "Segoe UI", Roboto, sans-serif; }
main { max-width: 1180px; margin: 0 auto; padding: 28px 24px 60px; }
h1 { font-size: 25px; margin: 0; letter-spacing: -0.01em; } h2 { font-size: 18px; margin: 38px 0 10px; }
h3 { font-size: 15px; margin: 22px 0 6px; } p { margin: 6px 0 10px; max-width: 85ch; } .soft { color: var(--soft); }
code, .mono { font: 13px/1.5 ui-monospace, "SF Mono", Menlo, Consolas, monospace; }
pre { background: var(--card); border: 1px solid var(--rule); border-radius: 6px; padding: 10px 14px; margin: 6px 0; white-space: pre-wrap; overflow-wrap: anywhere; }
.banner { background: var(--warn-paper); border-left: 4px solid var(--warn-rule); padding: 10px 16px; margin: 18px 0; border-radius: 3px; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(158px, 1fr)); gap: 12px; margin: 18px 0 6px; }
.tile { background: var(--card); border: 1px solid var(--rule); border-radius: 8px; padding: 11px 14px; }
.tile b { display: block; font-size: 23px; font-weight: 600; letter-spacing: -0.02em; font-variant-numeric: tabular-nums; }
.tile b small { font-size: 14px; font-weight: 500; color: var(--soft); } .tile span { color: var(--soft); font-size: 13px; }
.tile.bad b { color: var(--missed); } .tile.good b { color: var(--good); }
.scroll { overflow-x: auto; } .wide svg { min-width: 660px; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { padding: 5px 12px 5px 0; text-align: right; border-bottom: 1px solid var(--rule); vertical-align: top; }
th { color: var(--soft); font-weight: 500; font-size: 13px; } th:first-child, td:first-child, td.words, th.words { text-align: left; }
td.words { overflow-wrap: anywhere; } td .soft { font-size: 13px; }
table.numbers td { white-space: nowrap; } table.numbers th, table.numbers td { padding-right: 7px; } table.numbers { font-size: 14px; }
.key { display: inline-block; width: 12px; height: 12px; border-radius: 2px; margin: 0 5px 0 14px; vertical-align: -1px; }
.key:first-child { margin-left: 0; }
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(300px, 1fr)); gap: 14px; }
svg { width: 100%; height: auto; display: block; background: var(--card); border: 1px solid var(--rule); border-radius: 8px; font: 11px system-ui, sans-serif; }
svg text { fill: var(--soft); } svg .title { fill: var(--ink); font-size: 12px; font-weight: 600; }
svg .ylabel { text-anchor: end; } svg .xlabel { text-anchor: middle; } svg .unit { text-anchor: start; } svg .budgetlabel, svg .left { text-anchor: end; }
svg .budgetlabel { fill: var(--ink); paint-order: stroke; stroke: var(--card); stroke-width: 3px; } svg .plabel { fill: var(--ink); paint-order: stroke; stroke: var(--card); stroke-width: 3px; }
svg .grid { stroke: var(--rule); stroke-width: 1; } svg .axis { stroke: var(--soft); stroke-width: 1; }
svg .budget { stroke: var(--ink); stroke-width: 1.2; stroke-dasharray: 6 4; } svg .pmark { stroke: var(--ink); stroke-width: 1; opacity: 0.55; }
svg .warmup { fill: var(--soft); opacity: 0.13; } svg .framearea { fill: var(--frame-fill); } svg path { fill: none; stroke-width: 1.4; }
svg path.framearea { fill: var(--frame-fill); } svg .frameline { stroke: var(--frame); } svg .cpuline { stroke: var(--cpu); } svg .gpuline { stroke: var(--gpu); }
svg .missed, svg .clipped { fill: var(--missed); } svg .discarded { fill: var(--discarded); } svg .bar { fill: var(--frame); } svg .beyond { fill: var(--missed); }
svg .hit { fill: transparent; } svg .hit:hover { fill: var(--soft); opacity: 0.18; }
.run + .run { border-top: 3px solid var(--rule); margin-top: 46px; }
.headline { font-size: 17px; } ul { margin: 6px 0 10px; padding-left: 22px; } .banner ul { margin-bottom: 0; }
.changes th, .changes td { white-space: nowrap; } .changes tr.head td { border-top: 1px solid var(--soft); } td.verdict { white-space: nowrap; font-weight: 600; color: var(--soft); }
td.verdict.better { color: var(--good); } td.verdict.worse { color: var(--missed); } td.verdict.few { font-weight: 400; font-style: italic; }
svg .fine { fill: var(--fine); } svg .coarse { fill: var(--missed); } svg .dark { fill: var(--ink); } svg .device { fill: var(--frame-fill); }
svg rect.change { opacity: 0.45; } svg .better { fill: var(--good); } svg .worse { fill: var(--missed); } svg .same { fill: var(--soft); }
@media print { body { background: #fff; } .charts, svg, tr { break-inside: avoid; } }
)css";

}  // namespace probewalk
