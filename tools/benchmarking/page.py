"""One self-contained page: the table over seeds, and of each measure every run with mean and interval."""
import html
import json

from benchmarking.confidence import interval
from benchmarking.tables import MEASURES, groups, table_over_seeds, values_of

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")  # Okabe, Ito: for all eyes
WIDTH_OF_GROUP = 0.6  # of the distance between two recordings, for their variants

PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>PoseFusion: benchmark</title>
<style>
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 75rem; padding: 0 1rem; color: #222 }
table { border-collapse: collapse; display: block; overflow-x: auto }
th, td { padding: .25rem .6rem; border-bottom: 1px solid #ddd; text-align: right; white-space: nowrap }
th:nth-child(-n+2), td:nth-child(-n+2) { text-align: left }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(30rem, 1fr)); gap: 1.5rem }
figure { margin: 0; height: 22rem }
</style>
</head>
<body>
<h1>PoseFusion: benchmark</h1>
<p>Points are runs; bars are means with their 95 % intervals.</p>
<div class="plots" id="plots"></div>
<h2>Table</h2>
@table@
<script>@library@</script>
<script>
const plots = @plots@;
for (const plot of window.Chart ? plots : []) {
  const figure = document.createElement('figure'), canvas = document.createElement('canvas');
  figure.append(canvas);
  document.getElementById('plots').append(figure);
  const datasets = plot.variants.flatMap(variant => [
    { label: variant.name, data: variant.points, backgroundColor: variant.colour + '80', pointRadius: 3 },
    { label: '', data: variant.bars, type: 'line', borderColor: variant.colour, borderWidth: 2, spanGaps: false,
      pointStyle: 'line', pointRadius: 9, pointBorderWidth: 2, pointBorderColor: variant.colour }]);
  new Chart(canvas, { type: 'scatter', data: { datasets }, options: {
    maintainAspectRatio: false, animation: false,
    plugins: { title: { display: true, text: plot.title }, legend: { labels: { filter: item => item.text } } },
    scales: {
      y: { beginAtZero: true },
      x: { min: -0.5, max: plot.recordings.length - 0.5, grid: { display: false },
           afterBuildTicks: axis => axis.ticks = plot.recordings.map((_, value) => ({ value })),
           ticks: { callback: value => plot.recordings[value] } } } } });
}
</script>
</body>
</html>
"""


def plot(title, factor, measure, results):
    recordings = list(dict.fromkeys(result["recording"] for result in results))
    names = list(dict.fromkeys(result["variant"] for result in results))
    runs_of = groups(results)
    variants = []
    for i, name in enumerate(names):
        offset = WIDTH_OF_GROUP * ((i + 0.5) / len(names) - 0.5)
        points, bars = [], []
        for at, recording in enumerate(recordings):
            values = [factor * value for value in values_of(runs_of.get((recording, name), []), measure)]
            points += [{"x": at + offset, "y": value} for value in values]
            mean, half = interval(values)
            if mean is not None:
                ends = [mean] if half is None else [max(mean - half, 0), mean, mean + half]
                bars += [*({"x": at + offset, "y": end} for end in ends), {"x": at + offset, "y": None}]
        variants.append({"name": name, "colour": COLOURS[i % len(COLOURS)], "points": points, "bars": bars})
    return {"title": title, "recordings": recordings, "variants": variants}


def html_table(markdown):
    lines = [line for line in markdown.splitlines() if line.startswith("|")]
    rows = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines if not line.startswith("|---")]
    tags = ["th"] + ["td"] * (len(rows) - 1)
    body = ["".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in row) for tag, row in zip(tags, rows)]
    return "<table>\n" + "\n".join(f"<tr>{row}</tr>" for row in body) + "\n</table>"


def write_page(file, results, chart_library):
    """@param chart_library  Chart.js, as tools/setup brings it; without it the page has the table only"""
    plots = [plot(title, factor, measure, results) for title, factor, _, measure in MEASURES]
    plots = [each for each in plots if any(variant["points"] for variant in each["variants"])]
    parts = {
        "table": html_table(table_over_seeds(results)),
        "library": chart_library.read_text() if chart_library.exists() else "",
        "plots": json.dumps(plots).replace("</", "<\\/"),
    }
    text = PAGE
    for name, part in parts.items():
        text = text.replace(f"@{name}@", part, 1)
    file.write_text(text)
