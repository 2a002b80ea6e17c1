// A picture of a page opens alone, where it can be enlarged: drawings are small on a phone.
for (const img of document.querySelectorAll("article img")) {
  if (!img.closest("a")) {
    const link = document.createElement("a");
    link.href = img.src;
    img.replaceWith(link);
    link.append(img);
  }
}
