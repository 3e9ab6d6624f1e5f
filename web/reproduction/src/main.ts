const place = document.getElementById("report-data")!;
const { reproduction } = JSON.parse(place.textContent ?? "{}") as { reproduction: { exhibits: { id: string; title: string }[] } };
const main = document.createElement("main");
main.id = "content";
for (const { id, title } of reproduction.exhibits) {
  const heading = document.createElement("h2");
  heading.id = id;
  heading.textContent = title;
  main.append(heading);
}
document.getElementById("page")!.append(main);
