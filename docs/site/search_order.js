/* Sphinx's scores, with explanations before lists of fields and functions. */
var Scorer = {
  score: ([page, , , , score]) => score + (/^(guide|theory)\//.test(page) ? 50 : /^(documents|python)\//.test(page) ? -50 : 0),
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
