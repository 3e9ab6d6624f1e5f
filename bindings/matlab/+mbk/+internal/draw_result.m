function handles = draw_result(result)
% Plots ellipses, or parameters with their intervals; below them the impedance over frequency.
  planar = size(result.model.K, 1) == 2;
  symbols = {'M', 'B', 'K'};
  names = {'inertia', 'damping', 'stiffness'};
  handles = zeros(1, 0);
  for k = 1:3
    handles(end + 1) = subplot(2, 3, k);
    unit = mbk.internal.unit_of(result, symbols{k});
    if planar
      ellipse(result, names{k}, unit);
    else
      interval(result.model.(symbols{k}), result.standard_error.(symbols{k}), names{k}, unit);
    end
    title(names{k});
  end
  handles(end + 1) = subplot(2, 3, 4:6);
  impedance(result);
end

function ellipse(result, name, unit)
  [colour, light] = mbk.internal.style(name);
  if ~isfield(result, 'ellipses') || ~all(result.ellipses.(name).eigenvalues > 0)
    text(0, 0, 'no ellipse', 'HorizontalAlignment', 'center');
    axis([-1 1 -1 1]);
  else
    found = result.ellipses.(name);
    small = found.eigenvalues(1);
    large = found.eigenvalues(2);
    turn = found.orientation_deg * pi / 180;
    range = found.interval95.orientation_deg * pi / 180;
    if numel(range) == 2 && all(isfinite(range)) && diff(range) < pi  % interval of the major axis
      for half = [0 pi]
        arc = linspace(range(1), range(2), 31) + half;
        fill([0, large * cos(arc)], [0, large * sin(arc)], light, 'EdgeColor', 'none');
        hold on
      end
    end
    angle = linspace(0, 2 * pi, 181);
    rotation = [cos(turn), -sin(turn); sin(turn), cos(turn)];
    curve = rotation * [large * cos(angle); small * sin(angle)];
    major = rotation * [-large, large; 0, 0];
    plot(curve(1, :), curve(2, :), 'Color', colour, 'LineWidth', 1.5);
    hold on
    plot(major(1, :), major(2, :), '--', 'Color', colour);
    hold off
    axis(1.12 * large * [-1 1 -1 1]);
    set(gca, 'XTick', round_below(large) * [-1 0 1], 'YTick', round_below(large) * [-1 0 1]);
  end
  axis square
  grid on
  mbk.internal.label(mbk.internal.with_unit('x', unit), mbk.internal.with_unit('y', unit));
end

function number = round_below(limit)
% Largest 1, 2 or 5 times a power of ten up to `limit`.
  decade = 10 ^ floor(log10(limit));
  steps = decade * [1 2 5];
  number = max(steps(steps <= limit));
end

function interval(value, standard_error, name, unit)
% Plots one parameter with its 95 % interval.
  half = 1.959963984540054 * standard_error;
  colour = mbk.internal.style(name);
  plot([1 1], value + half * [-1 1], 'Color', colour, 'LineWidth', 1.5);
  hold on
  plot(1, value, 'o', 'Color', colour);
  hold off
  xlim([0.3 1.7]);
  set(gca, 'XTick', []);
  grid on
  mbk.internal.label('95 % interval', mbk.internal.with_unit(name, unit));
end

function impedance(result)
  hz = logspace(-1, log10(20), 200);
  s = 2i * pi * hz;
  model = result.model;
  colours = {'first', 'second'};
  axes_count = size(model.K, 1);
  for k = 1:axes_count
    loglog(hz, abs(model.M(k, k) * s.^2 + model.B(k, k) * s + model.K(k, k)), ...
           'Color', mbk.internal.style(colours{k}), 'LineWidth', 1.5);
    hold on
  end
  hold off
  grid on
  xlim([0.1 20]);
  mbk.internal.label('frequency (Hz)', mbk.internal.with_unit('|M s^2 + B s + K|', mbk.internal.unit_of(result, 'K')));
  if axes_count == 2
    legend({'x', 'y'}, 'Location', 'southeast');
  end
end
