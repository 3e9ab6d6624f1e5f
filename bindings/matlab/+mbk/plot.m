function handles = plot(result)
% mbk.plot  The ellipses of a result, and its impedance over frequency.
%
%   HANDLES = mbk.plot(RESULT) draws what mbk.measure or mbk.identify found. With two axes: the ellipses of inertia,
%   damping and stiffness, each the force (in N) that one unit of acceleration, velocity or displacement in any
%   direction takes. Below: the magnitude of M s^2 + B s + K along each axis over frequency. HANDLES are the axes.
%
%   Of several results (RESULT.results), draw one: mbk.plot(RESULT.results{1}).
  if ~isstruct(result) || ~isfield(result, 'model')
    error('mbk:usage', 'this is no result of mbk.measure or mbk.identify');
  end
  model = result.model;
  planar = size(model.K, 1) == 2;
  handles = [];
  if planar
    names = {'M', 'B', 'K'};
    titles = {'Inertia', 'Damping', 'Stiffness'};
    for k = 1:3
      handles(end + 1) = subplot(2, 3, k);
      matrix = model.(names{k});
      angle = linspace(0, 2 * pi, 361);
      curve = (matrix + matrix') / 2 * [cos(angle); sin(angle)];
      plot(curve(1, :), curve(2, :), 'LineWidth', 1.5);
      axis equal
      grid on
      title(titles{k});
      unit = plain(result.units.(names{k}));
      xlabel(['x (' unit ')']);
      ylabel(['y (' unit ')']);
      set(gca, 'FontSize', 9);
    end
    handles(end + 1) = subplot(2, 3, 4:6);
  else
    handles(end + 1) = subplot(1, 1, 1);
  end
  hz = logspace(-1, log10(20), 200);
  s = 2i * pi * hz;
  labels = {'x', 'y'};
  for axis_number = 1:size(model.K, 1)
    k = axis_number;
    loglog(hz, abs(model.M(k, k) * s.^2 + model.B(k, k) * s + model.K(k, k)), 'LineWidth', 1.5);
    hold on
  end
  hold off
  grid on
  xlabel('frequency (Hz)');
  ylabel(['|M s^2 + B s + K| (' plain(result.units.K) ')']);
  xlim([0.1 20]);
  if planar
    legend(labels, 'Location', 'southeast');
  end
end

function text = plain(unit)
% Without the dot between factors, which not every font has.
  text = strrep(unit, char([194 183]), ' ');
  text = strrep(text, char(183), ' ');
end
