"""Names, roles and contrast of a page, for the tests of the pages in Chromium."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from verdicts import check  # noqa: E402

# Names, contrast and focus, as a reader with other senses needs them.
ACCESS = r"""(() => {
  const found = [], luminance = (c) => { const [r, g, b] = c.match(/[\d.]+/g).map((v) => (v /= 255) <= 0.04045 ? v / 12.92
      : ((v + 0.055) / 1.055) ** 2.4); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const ground = (e) => { for (; e; e = e.parentElement) { const c = getComputedStyle(e).backgroundColor;
      if (!/, 0\)$|transparent/.test(c)) return c; } return 'rgb(255, 255, 255)'; };
  let texts = 0, least = 21;
  for (const e of document.querySelectorAll('body *')) {
    if (!e.checkVisibility() || e.ariaHidden || ![...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim())) continue;
    const a = luminance(getComputedStyle(e).color), b = luminance(ground(e));
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    texts++, least = Math.min(least, ratio);
    if (ratio < 4.5) found.push('contrast ' + ratio.toFixed(2) + ' of ' + e.tagName + ' ' + e.textContent.slice(0, 30));
  }
  for (const name of ['ink', 'dim']) { /* text on canvases */
    const probe = document.createElement('i'); probe.style.color = 'var(--' + name + ')';
    probe.style.backgroundColor = 'var(--paper)'; document.body.append(probe);
    const s = getComputedStyle(probe), a = luminance(s.color), b = luminance(s.backgroundColor); probe.remove();
    if ((Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05) < 4.5) found.push('contrast of canvas text ' + name);
  }
  for (const name of ['blue', 'red', 'green', 'purple']) { /* lines: 3 to 1 */
    const probe = document.createElement('i'); probe.style.color = 'var(--' + name + ')';
    probe.style.backgroundColor = 'var(--paper)'; document.body.append(probe);
    const s = getComputedStyle(probe), a = luminance(s.color), b = luminance(s.backgroundColor); probe.remove();
    if ((Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05) < 3) found.push('contrast of line ' + name);
  }
  const named = (e) => e.getAttribute('aria-label') || e.closest('label') || e.textContent.trim();
  for (const e of document.querySelectorAll('button, select, input, canvas, section, a'))
    if (e.checkVisibility() && !named(e)) found.push('no name: ' + e.outerHTML.slice(0, 80));
  for (const e of document.querySelectorAll('canvas'))
    if (e.role !== 'img') found.push('no role: ' + e.id);
  const ids = [...document.querySelectorAll('[id]')].map((e) => e.id);
  if (new Set(ids).size !== ids.length) found.push('an id twice');
  if (!document.documentElement.lang || !document.title || !document.querySelector('main, [role=main]')) found.push('no language, title or main');
  return {found, texts, least};
})()"""


def access(tab, where):
    got = tab.run(ACCESS)
    check(f"names, roles and contrast ({where})", not got["found"],
          got["found"] or f"{got['texts']} texts, contrast {got['least']:.1f} or more")
