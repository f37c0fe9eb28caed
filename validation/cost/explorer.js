// Move a slider to and fro at 60 Hz for some seconds, and return how often a second the fields change.
(number, seconds, low, high) => new Promise(done => {
  const models = [...Bokeh.documents[0]._all_models.values()];
  const slider = models.filter(one => one.type === "Slider")[number];
  const fields = models.find(one => one.type === "ColumnDataSource" && "slip" in one.data);
  const start = performance.now();
  let shown = 0;
  fields.properties.data.change.connect(() => { shown += 1; });
  const move = () => {
    const t = (performance.now() - start) / 1e3;
    if (t > seconds) return done(shown / t);
    slider.value = low + (high - low) * (0.5 - 0.5 * Math.cos(1.7 * t));
    setTimeout(move, 16);
  };
  move();
})
