// Sorting and finding in the file of a report; without it every axis stands there, those without a gear first.
(() => {
  const table = document.getElementById('axes'), body = table.tBodies[0], rows = [...body.rows]
  const find = document.getElementById('find'), show = document.getElementById('show'), found = document.getElementById('found')

  const valueOf = (row, key) => {
    const cell = row.querySelector(`.${key}`)
    if (!cell) return null
    if (cell.dataset.value === undefined) return cell.textContent.trim()
    return cell.dataset.value === '' ? null : Number(cell.dataset.value)
  }
  const compare = (a, b) => (typeof a === 'number' ? a - b : a.localeCompare(b, undefined, { numeric: true }))

  const sort = (heading) => {
    const descending = heading.getAttribute('aria-sort') === 'ascending', key = heading.dataset.key
    for (const other of table.tHead.rows[0].cells) other.removeAttribute('aria-sort')
    heading.setAttribute('aria-sort', descending ? 'descending' : 'ascending')
    const keyed = rows.map((row, place) => [valueOf(row, key), place, row])
    keyed.sort(([a, i], [b, j]) => {
      if (a === null || b === null) return (a === null) - (b === null) || i - j
      return (descending ? compare(b, a) : compare(a, b)) || i - j
    })
    body.append(...keyed.map(([, , row]) => row))
  }

  const filter = () => {
    const text = find.value.trim().toLowerCase()
    let count = 0
    for (const row of rows) {
      row.hidden = !((!show.value || row.classList.contains(show.value)) && row.textContent.toLowerCase().includes(text))
      count += !row.hidden
    }
    found.textContent = count === rows.length ? '' : `${count} / ${rows.length}`
  }

  for (const heading of table.tHead.querySelectorAll('[data-key]')) {
    const button = document.createElement('button')
    button.type = 'button'
    button.append(...heading.childNodes)
    button.addEventListener('click', () => sort(heading))
    heading.append(button)
  }
  find.addEventListener('input', filter)
  show.addEventListener('change', filter)
  document.getElementById('finding').hidden = false
})()
