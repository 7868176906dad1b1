'use strict';
// Draws the plots of a run. The data stand in the element #run; see run_json.cpp for their form.
(function () {
  if (typeof Chart === 'undefined') {
    document.body.classList.add('no-plots');
    return;
  }
  const run = JSON.parse(document.getElementById('run').textContent);
  const COLORS = ['#1f77b4', '#ff7f0e', '#2ca02c', '#d62728', '#9467bd', '#8c564b', '#e377c2', '#17becf', '#bcbd22',
    '#7f7f7f', '#aec7e8', '#ffbb78', '#98df8a', '#ff9896', '#c5b0d5', '#c49c94'];
  const TRUTH = '#9aa5b1';
  Chart.defaults.animation = false;
  Chart.defaults.maintainAspectRatio = false;
  Chart.defaults.font.size = 12;
  Chart.defaults.elements.point.radius = 0;
  Chart.defaults.elements.line.borderWidth = 1.5;

  const scaled = (values, factor) => values.map(v => v === null ? null : v * factor);
  const pairs = (xs, ys) => ys.map((y, i) => ({x: xs[i] === undefined ? i : xs[i], y: y}));
  const known = values => values.some(v => v !== null);
  const axis = (text, more) => Object.assign({type: 'linear', title: {display: true, text: text}}, more);
  const right_axis = (text, more) =>
    axis(text, Object.assign({position: 'right', grid: {drawOnChartArea: false}}, more));
  const line = (label, points, index, more) => {
    const color = COLORS[index % COLORS.length];
    return Object.assign({label: label, data: points, borderColor: color, backgroundColor: color}, more);
  };

  // Over time: lost intervals shaded, loops and relocalisations as upright lines, keyframes as ticks at the foot.
  const [LOST, LOOP, RELOCALISED, KEYFRAME] = ['lost', 'loop', 'relocalised', 'keyframe'].map(
    name => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim());
  const marks = x_of => ({
    id: 'marks',
    beforeDatasetsDraw(chart) {
      const {ctx, chartArea: area, scales: {x}} = chart;
      const at = frame => x.getPixelForValue(x_of(frame));
      ctx.save();
      ctx.beginPath();
      ctx.rect(area.left, area.top, area.width, area.height);
      ctx.clip();
      ctx.fillStyle = LOST;
      for (const [first, last] of run.lost) {
        const left = at(first - 0.5);
        ctx.fillRect(left, area.top, Math.max(at(last + 0.5) - left, 1), area.height);
      }
      const upright = (color, frame, top, dash) => {
        ctx.strokeStyle = color;
        ctx.setLineDash(dash);
        ctx.beginPath();
        ctx.moveTo(at(frame), top);
        ctx.lineTo(at(frame), area.bottom);
        ctx.stroke();
      };
      for (const frame of run.keyframes) upright(KEYFRAME, frame, area.bottom - 6, []);
      for (const loop of run.loops) {
        const color = loop.kind === 'relocalisation' ? RELOCALISED : LOOP;
        if (loop.accepted) upright(color, loop.frame, area.top, [5, 3]);
      }
      ctx.restore();
    },
  });
  const by_frame = marks(frame => frame);
  const by_time = marks(frame => {  // also between two frames
    const i = Math.min(Math.max(Math.floor(frame), 0), run.time_s.length - 2);
    return run.time_s.length < 2 ? 0 : run.time_s[i] + (frame - i) * (run.time_s[i + 1] - run.time_s[i]);
  });

  const seconds = axis('time (s)'), frame = axis('frame');

  function drop(id) { document.getElementById(id).closest('figure').remove(); }

  function plot(id, title, datasets, scales, more) {
    if (datasets.length === 0) { drop(id); return; }
    new Chart(document.getElementById(id), {
      type: 'line',
      data: {datasets: datasets},
      plugins: [scales.x === seconds ? by_time : by_frame],
      options: Object.assign({
        parsing: false,
        interaction: {mode: 'nearest', axis: 'x', intersect: false},
        plugins: {
          title: {display: true, text: title},
          legend: {display: datasets.length > 1, labels: {boxWidth: 14}},
          decimation: {enabled: true, algorithm: 'min-max'},
        },
        scales: scales,
      }, more),
    });
  }

  // A dot where such a line begins, and its name beside it.
  const names_at_start = {
    id: 'names_at_start',
    afterDatasetsDraw(chart) {
      const {ctx, chartArea: area} = chart;
      ctx.save();
      ctx.font = '600 12px system-ui, sans-serif';
      chart.data.datasets.forEach((set, i) => {
        const first = chart.getDatasetMeta(i).data[0];
        if (set.name_at_start === undefined || !first || !chart.isDatasetVisible(i)) return;
        const DOT = 4, TURN = 2 * Math.PI;
        ctx.fillStyle = set.borderColor;
        ctx.beginPath();
        ctx.arc(first.x, first.y, DOT, 0, TURN);
        ctx.fill();
        ctx.fillStyle = '#1f2933';
        const right = area.right - ctx.measureText(set.name_at_start).width - DOT;
        ctx.fillText(set.name_at_start, Math.min(first.x + 2 * DOT, right), Math.max(first.y - DOT, area.top + 12));
      });
      ctx.restore();
    },
  };

  // Paths: equal units on both axes.
  function path(id, title, x, y, x_label, y_label) {
    const figure = document.getElementById(id).closest('figure');
    figure.classList.add('square');
    const all = run.estimate.concat(run.groundtruth, ...run.objects.map(o => o.path.filter(p => p[0] !== null)));
    if (all.length === 0) { drop(id); return; }
    const range = k => [Math.min(...all.map(p => p[k])), Math.max(...all.map(p => p[k]))];
    const [x0, x1] = range(x), [y0, y1] = range(y);
    const AXES_WIDTH = 70, AXES_HEIGHT = 100, MARGIN = 1.1, SMALLEST = 0.02;
    const width = Math.max(figure.clientWidth - AXES_WIDTH, 100);
    const height = Math.max(figure.clientHeight - AXES_HEIGHT, 100);
    const unit = MARGIN * Math.max((x1 - x0) / width, (y1 - y0) / height, SMALLEST / height);
    const limits = (low, high, size) => ({min: (low + high - unit * size) / 2, max: (low + high + unit * size) / 2,
      ticks: {includeBounds: false}});
    const points = list => list.map(p => ({x: p[x] ?? NaN, y: p[y] ?? NaN}));  // NaN interrupts the line
    const sets = [];
    if (run.groundtruth.length) {
      sets.push(line('ground truth', points(run.groundtruth), 0,
        {borderColor: TRUTH, backgroundColor: TRUTH, borderWidth: 3, order: 1}));
    }
    sets.push(line('estimate', points(run.estimate), 0));
    run.loop_links.forEach((link, i) => sets.push(line(i === 0 ? 'loop' : '', points(link), 0,
      {borderColor: LOOP, backgroundColor: LOOP, borderWidth: 2.5, pointRadius: 4, order: -2})));
    if (run.keyframe_positions.length) {
      sets.push(line('keyframe', points(run.keyframe_positions), 0,
        {showLine: false, pointRadius: 2.5, borderWidth: 0, pointBackgroundColor: KEYFRAME, backgroundColor: KEYFRAME,
          order: -1}));
    }
    for (const object of run.objects) {
      sets.push(line('object ' + object.label, points(object.path), 0, {borderColor: object.color,
        backgroundColor: object.color, borderWidth: 2.5, borderJoinStyle: 'round', order: -1,
        name_at_start: String(object.label)}));
    }
    new Chart(document.getElementById(id), {
      type: 'scatter',
      plugins: [names_at_start],
      data: {datasets: sets.map(s => Object.assign({showLine: true}, s))},
      options: {
        plugins: {
          title: {display: true, text: title},
          legend: {labels: {boxWidth: 14, filter: (item, data) => item.text !== '' &&
            data.datasets[item.datasetIndex].name_at_start === undefined}},
        },
        scales: {x: axis(x_label, limits(x0, x1, width)), y: axis(y_label, limits(y0, y1, height))},
      },
    });
  }
  path('path_above', 'Seen from above', 0, 1, 'right (m)', 'forward (m)');
  path('path_side', 'Seen from the side', 1, 2, 'forward (m)', 'up (m)');

  const zero = {beginAtZero: true};
  const errors = run.errors;
  if (errors) {
    plot('ate', 'Absolute trajectory error', [line('ATE', pairs(errors.ate_t, scaled(errors.ate_m, 100)), 3)],
      {x: seconds, y: axis('cm', zero)});
  } else {
    drop('ate');
  }
  if (errors && errors.rpe_t) {
    plot('rpe', 'Relative pose error over one second', [
      line('translation', pairs(errors.rpe_t, scaled(errors.rpe_m, 100)), 0),
      line('rotation', pairs(errors.rpe_t, errors.rpe_deg), 1, {yAxisID: 'deg'}),
    ], {x: seconds, y: axis('cm', zero), deg: right_axis('degrees', {beginAtZero: true, suggestedMax: 0.1})});
  } else {
    drop('rpe');
  }

  plot('host_times', 'Stages of the pipeline', run.host_stages.map((s, i) => line(s.name, pairs([], s.ms), i)),
    {x: frame, y: axis('ms', zero)});
  const stacked = (stage, i) =>
    line(stage.name, pairs([], stage.ms.map(v => v === null ? 0 : v)), i, {fill: true, borderWidth: 0});
  plot('gpu_times', 'GPU, stages stacked', run.gpu_stages.map(stacked),
    {x: frame, y: axis('ms', {beginAtZero: true, stacked: true})});

  const f = run.frames;
  const series = (label, values, index, more) => known(values) ? [line(label, pairs([], values), index, more)] : [];
  plot('inliers', 'Share of the static pixels that track', series('inliers', scaled(f.inliers, 100), 2),
    {x: frame, y: axis('%', {min: 0, max: 100})});
  const right = {yAxisID: 'photometric'};
  plot('residuals', 'Residuals of the last iteration',
    series('point to plane', scaled(f.icp_rmse_m, 1000), 0).concat(series('photometric', f.photometric_rmse, 1, right)),
    {x: frame, y: axis('mm', zero), photometric: right_axis('intensity, 0 to 1', zero)});
  plot('exposure', 'Factors that bring the colours into the exposure of the map',
    series('red', f.red, 1).concat(series('green', f.green, 2), series('blue', f.blue, 0)),
    {x: frame, y: axis('factor', {})});
  plot('surfels', 'Surfels', series('all', f.surfels, 0).concat(series('stable', f.stable_surfels, 2)),
    {x: frame, y: axis('surfels', zero)});
  const count = text => axis(text, {beginAtZero: true, ticks: {precision: 0}});
  plot('people', 'People cut out', series('people', f.people, 1, {stepped: true}), {x: frame, y: count('people')});
  plot('keyframes', 'Keyframes', series('keyframes', f.keyframes, 7, {stepped: true}),
    {x: frame, y: count('keyframes')});
}());
