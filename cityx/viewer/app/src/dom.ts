/** Small helpers to make elements. */

type Child = Node | string | null | undefined | false;

export function el<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  given: Record<string, string | boolean | ((event: Event) => void)> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(given)) {
    if (typeof value === 'function') made.addEventListener(name, value);
    else if (typeof value === 'boolean') made.toggleAttribute(name, value);
    else made.setAttribute(name, value);
  }
  made.append(...children.filter((child): child is Node | string => child !== null && child !== undefined && child !== false));
  return made;
}

export function byId<T extends HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`The page has no element ${id}.`);
  return found as T;
}

export function table(rows: Iterable<[string, Child]>): HTMLTableElement {
  const body = el('tbody');
  for (const [name, value] of rows) body.append(el('tr', {}, el('th', { scope: 'row' }, name), el('td', {}, value)));
  return el('table', {}, body);
}

export function link(text: string, click: () => void): HTMLButtonElement {
  return el('button', { type: 'button', class: 'link', click }, text);
}

/** Hand a file to the user. */
export function save(name: string, content: Blob): void {
  const address = URL.createObjectURL(content);
  el('a', { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

export function words(name: string): string {
  return name.replaceAll('_', ' ');
}
