## octave_pipeline (LOG, TURNS): the published procedure (Dyck 2013, appendix C) with Octave and its signal package, as a
## skilled user would write it: weights by sgolay, filter for the convolution, filtfilt for the low-pass, backslash for
## the fit. Prints the seconds of each turn and the last M, B and K as one line of JSON. For pipeline.py.
function octave_pipeline (log, turns)
  pkg load signal
  data = load (log);
  logs = data.logs(:, 12001:61999)';
  position = logs(:, 2:3);
  force = logs(:, 10:11);
  [b, a] = butter (5, 5 / 500);
  weights = {sgolay(6, 101, 0, 1e-3), sgolay(6, 101, 1, 1e-3), sgolay(6, 101, 2, 1e-3)};
  filters_s = zeros (1, turns);
  all_s = zeros (1, turns);
  for k = 1:turns
    start = cputime ();
    signals = [smooth(position, weights{3}), smooth(position, weights{2}), smooth(position, weights{1}), ...
               smooth(force, weights{1})];
    signals = filtfilt (b, a, signals);
    filters_s(k) = cputime () - start;
    Z = [signals(1:40000, 1:6), ones(40000, 1)];
    P = Z \ -signals(1:40000, 7:8);
    all_s(k) = cputime () - start;
  endfor
  printf ("%s\n", jsonencode (struct ("filters_s", filters_s, "all_s", all_s, "M", P(1:2, :)', "B", P(3:4, :)', ...
                                      "K", P(5:6, :)')));
endfunction

## The middle row of sgolay's matrix holds the weights at the centre of the window.
function result = smooth (signals, all_weights)
  w = all_weights((rows (all_weights) + 1) / 2, :);
  result = filter (fliplr (w), 1, signals);
  result = result(numel (w):end, :);
endfunction
