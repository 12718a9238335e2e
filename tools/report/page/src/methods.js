// The methods, in the order in which figures show them; each has a colour of its name in page.css.

const titles = {flat: 'Flat polygons', shaded: 'Force shading', gregory: 'Gregory patches'};
const order = Object.keys(titles);

export const methodTitle = method => titles[method] || method;
export const methodColor = method => method in titles ? method : 'neutral';

export function inOrder(methods) {
  const place = ({method}) => (order.indexOf(method) + order.length + 1) % (order.length + 1);
  return [...methods].sort((a, b) => place(a) - place(b));
}
