// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0

type Child = Node | string | number | null | undefined | false | Child[];
type Properties = Record<string, unknown>;

function put(element: Element, properties: Properties, children: Child[]): void {
  for (const [key, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith('on')) element.addEventListener(key.slice(2), value as EventListener);
    else element.setAttribute(key, value === true ? '' : String(value));
  }
  for (const child of children) {
    if (Array.isArray(child)) put(element, {}, child);
    else if (child !== null && child !== undefined && child !== false)
      element.append(child instanceof Node ? child : String(child));
  }
}

/** An element with attributes (on...: listeners; tip: what hovering explains) and children. Text is never read as HTML. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Properties = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  put(element, properties, children);
  return element;
}

export function svg(tag: string, properties: Properties = {}, ...children: Child[]): SVGElement {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  put(element, properties, children);
  return element;
}

/** Shows the `tip` attribute of what the pointer or the keyboard focus is on. */
export function installTips(): void {
  const bubble = h('div', { class: 'tip', role: 'tooltip', hidden: true });
  document.body.append(bubble);
  const show = (target: EventTarget | null) => {
    const owner = target instanceof Element && target.isConnected ? target.closest('[tip]') : null;
    bubble.hidden = owner === null;
    if (!owner) return;
    bubble.textContent = owner.getAttribute('tip');
    const at = owner.getBoundingClientRect();
    const size = bubble.getBoundingClientRect();
    bubble.style.left = `${Math.max(6, Math.min(at.left + at.width / 2 - size.width / 2, innerWidth - size.width - 6))}px`;
    bubble.style.top = `${at.bottom + 6 + size.height < innerHeight ? at.bottom + 6 : Math.max(6, at.top - size.height - 6)}px`;
  };
  let timer = 0;
  document.addEventListener('pointerover', (event) => {
    clearTimeout(timer);
    show(null);
    timer = window.setTimeout(() => show(event.target), 350);
  });
  document.addEventListener('pointerdown', () => {
    clearTimeout(timer);
    show(null);
  });
  document.addEventListener('focusin', (event) => {
    if ((event.target as Element).matches(':focus-visible')) show(event.target);
  });
  document.addEventListener('focusout', () => show(null));
  document.addEventListener('scroll', () => show(null), true);
}
