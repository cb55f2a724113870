// What the explorer's page draws in the browser. Bokeh hands the models named in each callback's args to this code.

// Centre of the chart's cell under the pointer, not the pointer's own place: that is where the numbers belong.
function coordinate(special, axis) {
  const { i, j } = special.image_index
  const [rows, columns] = cells.data.growth[0].shape
  const { x, y, dw, dh } = cells.data
  const value = axis === "Omega" ? x[0] + ((i + 0.5) * dw[0]) / columns : y[0] + ((j + 0.5) * dh[0]) / rows
  return Math.abs(value) < 1e-12 * dh[0] ? "0" : Number(value.toPrecision(6)).toString()
}

// The point nearest to a click, measured in the window's own width and height.
function nearest(x, y) {
  const { Omega, eps } = points.data
  const width = chart.x_range.end - chart.x_range.start
  const height = chart.y_range.end - chart.y_range.start
  let best = 0
  let least = Infinity
  for (let k = 0; k < Omega.length; k++) {
    const distance = Math.hypot((Omega[k] - x) / width, (eps[k] - y) / height)
    if (distance < least) [best, least] = [k, distance]
  }
  return best
}

function fastest() {
  const { rate } = points.data
  return rate.reduce((best, value, k) => (value > rate[best] ? k : best), 0)
}

// Amplitudes are drawn on an asinh scale: linear near zero, decades far from it.
const DECADE = Math.LN10

function scaled(log_modulus, sign) {
  // asinh(w / 2) / ln 10 without overflow
  const size = log_modulus > 30 ? log_modulus : Math.asinh(Math.exp(log_modulus) / 2)
  return (sign * size) / DECADE
}

function superscript(n) {
  return [...String(n)].map((c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c]).join("")
}

function amplitudeLabel(tick) {
  if (tick === 0) return "0"
  const decade = Math.round(Math.log10(2 * Math.sinh(Math.abs(tick) * DECADE)))
  const sign = tick < 0 ? "−" : ""
  return decade < 2 ? sign + 10 ** decade : sign + "10" + superscript(decade)
}

function draw(k) {
  const { Omega, eps, rate, error, kind, coordinate, mu_re, mu_im, re, im, wave_re, wave_im } = points.data
  if (Omega.length === 0) return
  const unstable = kind[k] > 0

  const shown = { x: [], y: [], colour: [], value: [], modulus: [] }
  const count = re.length / Omega.length
  let reach = 1
  for (let m = k * count; m < (k + 1) * count; m++) {
    const modulus = Math.hypot(re[m], im[m])
    const radius = modulus > 1 ? 1 + Math.log10(modulus) : modulus
    const angle = Math.atan2(im[m], re[m])
    reach = Math.max(reach, radius)
    shown.x.push(radius * Math.cos(angle))
    shown.y.push(radius * Math.sin(angle))
    shown.colour.push(unstable && modulus > 1 + 1e-6 ? colours[1] : colours[0])
    shown.value.push(`${re[m].toPrecision(5)} ${im[m] < 0 ? "−" : "+"} ${Math.abs(im[m]).toPrecision(5)} i`)
    shown.modulus.push(modulus)
  }
  multipliers.data = shown
  const half = 1.15 * reach
  const aspect = circle.inner_width > 0 ? circle.inner_width / circle.inner_height : 1.35
  circle.y_range.setv({ start: -half, end: half })
  circle.x_range.setv({ start: -half * aspect, end: half * aspect })

  const samples = wave_re.length / Omega.length
  const log_mu = Math.log(Math.hypot(mu_re[k], mu_im[k]))
  const angle_mu = Math.atan2(mu_im[k], mu_re[k])
  const t = []
  const w = []
  let top = 0
  for (let n = 0; n < periods * samples; n++) {
    const period = Math.floor(n / samples)
    const at = k * samples + (n % samples)
    const log_size = Math.log(Math.hypot(wave_re[at], wave_im[at])) + period * log_mu
    const phase = Math.cos(Math.atan2(wave_im[at], wave_re[at]) + period * angle_mu)
    t.push(n / samples)
    w.push(phase === 0 ? 0 : scaled(log_size + Math.log(Math.abs(phase)), Math.sign(phase)))
    top = Math.max(top, Math.abs(w[n]))
  }
  solution.data = { t, w }
  wave.y_range.setv({ start: -1.08 * top, end: 1.08 * top })
  const step = Math.max(1, Math.ceil(top / 4))
  const ticks = [0]
  for (let decade = step > 1 ? step : 0; scaled(decade * DECADE, 1) <= top; decade += step) {
    ticks.push(scaled(decade * DECADE, 1), scaled(decade * DECADE, -1))
  }
  ticker.ticks = ticks.sort((a, b) => a - b)
  wave.title.text = `dominant solution, coordinate ${coordinate[k]}`

  marker.data = { x: [Omega[k]], y: [eps[k]] }
  const growth = `growth rate ${rate[k].toPrecision(5)}, ×${Math.exp(log_mu).toPrecision(4)} a period`
  facts.text =
    `<b>Ω = ${Number(Omega[k].toPrecision(6))}, ε = ${Number(eps[k].toPrecision(5))}:</b> ` +
    `${new Map(names).get(kind[k])}<br>${growth}<br>` +
    `<span style="color:#777">estimated error of log|μ| ${error[k].toExponential(1)}</span>`
}
