"""JavaScript that looks at a page or at a screenshot."""

# Elements beyond the right edge of the screen that no box scrolls.
SIDEWAYS = """(() => {
  const width = document.documentElement.clientWidth, wide = [];
  if (document.documentElement.scrollWidth > width) wide.push('the page, by ' + (document.documentElement.scrollWidth - width));
  const scrolls = e => e && (getComputedStyle(e).overflowX !== 'visible' || scrolls(e.parentElement));
  for (const e of document.body.querySelectorAll('*'))
    if (e.getBoundingClientRect().right > width + 1 && !scrolls(e.parentElement) && !e.closest('svg'))
      wide.push(e.tagName + ' ' + e.className + ': ' + e.textContent.slice(0, 40));
  return wide;
})()"""

# Pictures that are not decoded, and drawings without extent.
UNSEEN = """[...document.querySelectorAll('img, svg')]
  .filter(e => e.tagName === 'IMG' ? !(e.complete && e.naturalWidth > 0) : !(e.getBoundingClientRect().height > 20))
  .map(e => e.alt || e.getAttribute('aria-label') || e.outerHTML.slice(0, 60))"""

COUNT = "document.querySelectorAll('img, svg').length"


def figures(selector, pattern):
    """Texts below the selector that match the pattern: each with its text and the link around it, if any."""
    return """(() => {
  const found = [];
  for (const root of document.querySelectorAll(%s)) {
    const walk = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
    for (let node; (node = walk.nextNode());) {
      if (!new RegExp(%s).test(node.data)) continue;
      const link = node.parentElement.closest('a[href*="#row="]');
      found.push({text: link ? link.textContent : node.data, link: link && link.getAttribute('href')});
    }
  }
  return found;
})()""" % (repr(selector), repr(pattern))


def boxes(selector):
    """Place of each element in the document."""
    return """[...document.querySelectorAll(%s)].map(e => {
  const r = e.getBoundingClientRect();
  return {x: r.x + scrollX, y: r.y + scrollY, width: r.width, height: r.height};
})""" % repr(selector)


def look(png):
    """Of a PNG as base64: mean colour, share of pixels that differ from the most frequent colour, means of 4 × 3 parts."""
    return """(async () => {
  const bitmap = await createImageBitmap(await (await fetch('data:image/png;base64,%s')).blob());
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height), context = canvas.getContext('2d');
  context.drawImage(bitmap, 0, 0);
  const {data, width, height} = context.getImageData(0, 0, bitmap.width, bitmap.height);
  const counts = new Map(), parts = [...Array(12)].map(() => [0, 0, 0, 0]);
  for (let i = 0; i < data.length; i += 4) {
    const color = data[i] << 16 | data[i + 1] << 8 | data[i + 2];
    counts.set(color, (counts.get(color) || 0) + 1);
    const x = i / 4 %% width, y = Math.floor(i / 4 / width);
    const part = parts[Math.floor(3 * y / height) * 4 + Math.floor(4 * x / width)];
    for (let c = 0; c < 3; ++c) part[c] += data[i + c];
    ++part[3];
  }
  const paper = [...counts].reduce((a, b) => b[1] > a[1] ? b : a)[0];
  let ink = 0;
  for (const [color, count] of counts)
    if ([16, 8, 0].some(s => Math.abs((color >> s & 255) - (paper >> s & 255)) > 48)) ink += count;
  const mean = [0, 1, 2].map(c => parts.reduce((sum, p) => sum + p[c], 0) / (width * height));
  return {mean, ink: ink / (width * height), paper: [paper >> 16, paper >> 8 & 255, paper & 255],
          parts: parts.map(p => [0, 1, 2].map(c => p[c] / Math.max(p[3], 1)))};
})()""" % png
